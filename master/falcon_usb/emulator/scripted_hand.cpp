#include "master/falcon_usb/emulator/scripted_hand.hpp"

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

namespace farhand::falcon_usb {
namespace {

constexpr double kGripMass = 0.12;  // [kg] of the grip that is told, its motors carry it
constexpr double kSpeed = 0.06;     // [m/s] of a hand that is told, on average
constexpr double kRest = 0.3;       // [s] until a grip that was brought somewhere rests
constexpr Duration kAnswerTime = std::chrono::milliseconds(1);
const Vec3 kMiddle = HandLinkage<FalconGeometry>::middle(), kHomingReach(0, 0, 0.03);

// Of all the words that are left.
std::uint8_t buttons(std::istringstream& words) {
  constexpr std::pair<const char*, std::uint8_t> kNames[] = {{"centre", kButtonCentre},
                                                             {"forward", kButtonForward},
                                                             {"plus", kButtonPlus},
                                                             {"minus", kButtonMinus}};
  std::uint8_t out = 0;
  for (std::string word; words >> word;) {
    const auto is = [&](const auto& name) { return word == name.first; };
    const auto named = std::find_if(std::begin(kNames), std::end(kNames), is);
    if (named == std::end(kNames))
      throw std::runtime_error("there is no button '" + word +
                               "'; it can be centre, forward, plus or minus");
    out |= named->second;
  }
  if (out == 0) throw std::runtime_error("press wants a button");
  return out;
}

// As many as asked for, and nothing behind them.
std::vector<double> numbers(std::istringstream& words, std::size_t count, const char* what) {
  std::vector<double> out;
  for (double x = 0; words >> x;) out.push_back(x);
  if (!words.eof() || out.size() != count) throw std::runtime_error(what);
  return out;
}

// The grip is like a real one to motors that move it, and a hand that holds it as firm as a jig.
SimHandConfig told_hand(bool holds, double hung) {
  SimHandConfig out{.user = std::nullopt, .presses = {}, .encoder_step = 0};
  out.device = {
      .mass = 0.3, .damping = 8, .friction = 0.3, .weight = (kGripMass + hung) * kGravity};
  if (holds) out.user = OperatorConfig{.impedance = {.stiffness = 5000, .damping = 120}};
  return out;
}

}  // namespace

SimHandConfig hand_script(HandMotion motion) {
  SimHandConfig out{.user = OperatorConfig{}, .presses = {}, .encoder_step = 0};
  out.device.weight = 0;
  if (motion == HandMotion::none) return out;
  out.presses = {{Button::dead_man, 3.5, 0.8}, {Button::clutch, 3.5, 0.8}, {Button::dead_man, 5}};
  MotionConfig& wish = out.user->motion;
  wish.reaches = {{0.5, 0.8, {0, 0, 0.03}}, {1.5, 0.8, {0, 0, -0.06}}, {2.5, 0.8, {0, 0, 0.03}}};
  if (motion == HandMotion::circle)
    wish.sines = {{.from = 5, .frequency = 0.25, .offset = {0.02, 0, 0}},
                  {.from = 6, .frequency = 0.25, .offset = {0, 0.02, 0}}};
  return out;
}

ScriptedHand::ScriptedHand(HandMotion motion, const EmulatedHandConfig& device)
    : motion_(motion), device_(device) {
  begin_again();
}

void ScriptedHand::begin_again() {
  const std::lock_guard lock(mutex_);
  hand_.emplace(device_, hand_script(motion_));
  asked_.reset();
  scripted_ = holds_ = true;
  buttons_ = 0;
  hung_ = 0;
  rests_at_.reset();
}

void ScriptedHand::tell(const std::string& line) {
  const std::lock_guard lock(mutex_);
  std::istringstream words(line);
  std::string word;
  words >> word;
  if (word == "home") return bring({kMiddle + kHomingReach, kMiddle - kHomingReach, kMiddle});
  if (word == "move") {
    const auto p = numbers(words, 3, "move wants three numbers, in millimetres");
    return bring({1e-3 * Vec3(p[0], p[1], p[2])});
  }
  if (line == "let go") return let_go();
  if (word == "press") return press(buttons_ | buttons(words));
  if (line == "release") return press(0);
  if (word == "weight") {
    hung_ = 1e-3 * numbers(words, 1, "weight wants one number, in grams").front();
    if (!holds_) let_go();
    return;
  }
  throw std::runtime_error("the hand does not understand '" + line +
                           "'; it can home, move X Y Z, let go, press BUTTON ..., release, and "
                           "have weight GRAMS hung on the grip");
}

bool ScriptedHand::arrived() {
  const std::lock_guard lock(mutex_);
  if (!rests_at_ || hand_->truth().t < *rests_at_) return false;
  rests_at_.reset();
  return true;
}

Mechanism ScriptedHand::mechanism() {
  return {.read =
              [this](TimePoint now) {
                const std::lock_guard lock(mutex_);
                GripState out = hand_->read(slowed(now));
                out.buttons |= buttons_;
                return out;
              },
          .drive =
              [this](TimePoint now, const AxisWords& counts) {
                const std::lock_guard lock(mutex_);
                hand_->drive(slowed(now), counts);
              }};
}

TimePoint ScriptedHand::slowed(TimePoint now) noexcept {
  time_ += std::clamp(now - asked_.value_or(now), Duration::zero(), kAnswerTime);
  asked_ = now;
  return time_;
}

// Holds the grip and brings it to one stop after the other.
void ScriptedHand::bring(const std::vector<Vec3>& stops) {
  SimHandConfig next = told_hand(true, hung_);
  Vec3 from = place();
  double at = 0;
  for (const Vec3& to : stops) {
    const double lasting = std::max(kRest, (to - from).norm() / kSpeed);
    next.user->motion.reaches.push_back({at, lasting, to - from});
    at += lasting;
    from = to;
  }
  holds_ = true;
  replace(std::move(next));
  if (!stops.empty()) rests_at_ = at + kRest;
}

void ScriptedHand::let_go() {
  holds_ = false;
  replace(told_hand(false, hung_));
}

void ScriptedHand::press(std::uint8_t buttons) {
  if (scripted_) bring({});
  buttons_ = buttons;
}

// The next hand begins with the grip at rest where this one has it.
void ScriptedHand::replace(SimHandConfig next) {
  next.start_p_MH = place();
  hand_ = EmulatedHand(device_, std::move(next));
  scripted_ = false;
  rests_at_.reset();
}

Vec3 ScriptedHand::place() {
  hand_->read(time_);
  return hand_->truth().state.p_MH;
}

}  // namespace farhand::falcon_usb
