#include "common/scene_network.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "common/scene_values.hpp"

namespace farhand {
namespace {

JitterKind kind(proto::Impairment::Jitter jitter) {
  if (jitter == proto::Impairment::UNIFORM) return JitterKind::uniform;
  return jitter == proto::Impairment::NORMAL ? JitterKind::normal : JitterKind::gamma;
}

const char* name(JitterKind kind) {
  if (kind == JitterKind::uniform) return "uniform";
  return kind == JitterKind::normal ? "normal" : "gamma";
}

std::string describe(const std::optional<ImpairmentConfig>& config) {
  if (!config) return fmt::format("delay {:g} ms", 1e3 * seconds(Impairment::kPlainDelay));
  const ImpairmentConfig& c = *config;
  std::string out = fmt::format("delay {:g} ms", c.delay_ms);
  const auto add = [&](double value, const std::string& text) {
    if (value != 0) out += ", " + text;
  };
  add(c.jitter_ms, fmt::format("{} jitter {:g} ms{}", name(c.jitter_kind), c.jitter_ms,
                               c.keep_order ? " in order" : ""));
  add(c.spike_ms, fmt::format("spikes {:g} ms every {:g} s", c.spike_ms, c.spike_pause_s));
  add(c.step_ms, fmt::format("step {:g} ms at {:g} s", c.step_ms, c.step_at_s));
  add(c.delay_drift_ms_per_s, fmt::format("drift {:g} ms/s", c.delay_drift_ms_per_s));
  add(c.loss_ratio, fmt::format("loss {:g} %", 100 * c.loss_ratio));
  const double bursts = c.burst_enter_ratio / (c.burst_enter_ratio + c.burst_leave_ratio);
  add(c.burst_enter_ratio, fmt::format("loss {:.3g} % in bursts", 100 * bursts));
  add(c.duplicate_ratio, fmt::format("duplicates {:g} %", 100 * c.duplicate_ratio));
  add(c.reorder_ratio, fmt::format("held back {:g} %", 100 * c.reorder_ratio));
  add(c.corrupt_ratio, fmt::format("corrupt {:g} %", 100 * c.corrupt_ratio));
  const auto windows = std::count_if(c.blackouts.begin(), c.blackouts.end(),
                                     [](const Blackout& b) { return b.length_s > 0; });
  add(static_cast<double>(windows), fmt::format("blackouts: {}", windows));
  add(c.cap_kbit_per_s,
      fmt::format("at most {:g} kbit/s, queue {:g} B", c.cap_kbit_per_s, c.cap_queue_bytes));
  return out;
}

}  // namespace

LinkConfig link_config(const Scene& scene, std::uint64_t session, SecureChannel* secure) {
  const proto::Link& link = scene.proto.link();
  const double max_late_ms =
      link.has_max_late_ms() ? link.max_late_ms() : std::max(link.max_late_ms(), link.stale_ms());
  return {.session = session,
          .scene_hash = scene.shared_hash,
          .silence = milliseconds(link.lost_ms()),
          .max_late = milliseconds(max_late_ms),
          .secure = secure};
}

ImpairmentConfig impairment_config(const proto::Impairment& i) {
  ImpairmentConfig out{.delay_ms = i.delay_ms(),
                       .jitter_ms = i.jitter_ms(),
                       .jitter_kind = kind(i.jitter()),
                       .keep_order = i.keep_order(),
                       .loss_ratio = i.loss_ratio(),
                       .burst_enter_ratio = i.burst_enter_ratio(),
                       .burst_leave_ratio = i.burst_leave_ratio(),
                       .duplicate_ratio = i.duplicate_ratio(),
                       .reorder_ratio = i.reorder_ratio(),
                       .corrupt_ratio = i.corrupt_ratio(),
                       .spike_ms = i.spike_ms(),
                       .spike_pause_s = i.spike_pause_s(),
                       .step_ms = i.step_ms(),
                       .step_at_s = i.step_at_s(),
                       .step_length_s = i.step_length_s(),
                       .delay_drift_ms_per_s = i.delay_drift_ms_per_s(),
                       .cap_kbit_per_s = i.rate_cap().kbit_per_s(),
                       .cap_burst_bytes = i.rate_cap().burst_bytes(),
                       .cap_queue_bytes = i.rate_cap().queue_bytes()};
  std::transform(i.blackout().begin(), i.blackout().end(), out.blackouts.begin(),
                 [](const proto::Blackout& b) {
                   return Blackout{b.at_s(), b.length_s(), b.period_s()};
                 });
  return out;
}

std::optional<ImpairmentConfig> to_slave_config(const proto::Link& link) {
  if (!link.has_to_slave()) return {};
  return impairment_config(link.to_slave());
}

std::optional<ImpairmentConfig> to_master_config(const proto::Link& link) {
  if (!link.has_to_master()) return {};
  return impairment_config(link.to_master());
}

std::vector<std::string> network_stages(const proto::Link& link) {
  return {"to_slave          " + describe(to_slave_config(link)),
          "to_master         " + describe(to_master_config(link))};
}

}  // namespace farhand
