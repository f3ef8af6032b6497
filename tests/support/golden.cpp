#include "tests/support/golden.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>

namespace farhand::golden {

struct Reader {
  static Json copy(const nlohmann::json& from) {
    Json to;
    if (from.is_number() || from.is_boolean()) {
      to.kind_ = Json::Kind::number;
      to.number_ = from.is_boolean() ? double(from.get<bool>()) : from.get<double>();
    } else if (from.is_string()) {
      to.kind_ = Json::Kind::text;
      to.text_ = from.get<std::string>();
    } else if (from.is_structured()) {
      to.kind_ = from.is_array() ? Json::Kind::array : Json::Kind::object;
      for (const auto& [key, value] : from.items()) {
        if (from.is_object()) to.members_[key] = to.items_.size();
        to.items_.push_back(copy(value));
      }
    }
    return to;
  }
};

namespace {

Json load(const std::string& name) {
  const char* dir = std::getenv("FARHAND_GOLDEN_DIR");
  const std::string path =
      (dir != nullptr ? std::string(dir) : std::string(FARHAND_SOURCE_DIR "/tests/golden")) + "/" +
      name + ".json";
  std::ifstream in(path);
  if (!in) throw std::runtime_error("cannot open golden file " + path);
  return Reader::copy(nlohmann::json::parse(in));
}

void flatten(const Json& j, std::vector<double>& out) {
  if (!j.is_array()) return out.push_back(j);
  for (const Json& item : j) flatten(item, out);
}

}  // namespace

const Json& Json::at(const std::string& key) const {
  const auto member = members_.find(key);
  if (member == members_.end()) throw std::runtime_error("the golden vector has no " + key);
  return items_[member->second];
}

Json::operator double() const {
  if (kind_ != Kind::number) throw std::runtime_error("the golden value is no number");
  return number_;
}

Json::operator std::vector<int>() const {
  std::vector<int> out;
  for (const Json& item : items_) out.push_back(item.get<int>());
  return out;
}

const std::string& Json::text() const {
  if (kind_ != Kind::text) throw std::runtime_error("the golden value is no text");
  return text_;
}

Eigen::VectorXd column(const Json& j) {
  std::vector<double> flat;
  flatten(j, flat);
  return Eigen::Map<Eigen::VectorXd>(flat.data(), static_cast<Eigen::Index>(flat.size()));
}

Checker::~Checker() {
  for (const auto& [kind, k] : kinds_)
    std::printf("golden %s/%s: %d vectors, worst error/tolerance %.3g\n", file_.c_str(),
                kind.c_str(), k.vectors, k.worst);
}

void Checker::begin(const Json& vector) {
  kind_ = vector["kind"].get<std::string>();
  where_ = file_ + " id " + std::to_string(vector["id"].get<int>()) + " (" + kind_ + ", " +
           vector["tag"].get<std::string>() + ")";
  ++kinds_[kind_].vectors;
}

void Checker::values(const char* what, const Eigen::VectorXd& x, const Json& ref, double tol) {
  compare(what, x, column(ref), tol, false);
}
void Checker::angles(const char* what, const Eigen::VectorXd& x, const Json& ref, double tol) {
  compare(what, x, column(ref), tol, true);
}
void Checker::value(const char* what, double x, const Json& ref, double tol) {
  compare(what, Eigen::VectorXd::Constant(1, x), column(ref), tol, false);
}
void Checker::angle(const char* what, double x, const Json& ref, double tol) {
  compare(what, Eigen::VectorXd::Constant(1, x), column(ref), tol, true);
}

void Checker::compare(const char* what, const Eigen::VectorXd& x, const Eigen::VectorXd& ref,
                      double tol, bool modulo) {
  ASSERT_EQ(x.size(), ref.size()) << where_ << " " << what;
  double error = 0;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double d = modulo ? std::remainder(x[i] - ref[i], 2 * std::numbers::pi) : x[i] - ref[i];
    error = std::isfinite(d) ? std::max(error, std::abs(d)) : INFINITY;
  }
  const double ratio = error / (tol * std::max(1.0, ref.cwiseAbs().maxCoeff()));
  kinds_[kind_].worst = std::max(kinds_[kind_].worst, ratio);
  EXPECT_LE(ratio, 1.0) << where_ << " " << what << ": " << x.transpose() << " instead of "
                        << ref.transpose();
}

void run(const std::string& file, const Handlers& handlers,
         const std::vector<std::string>& elsewhere) {
  const Json all = load(file);
  Checker check(file);
  for (const Json& v : all["vectors"]) {
    const auto kind = v["kind"].get<std::string>();
    if (std::find(elsewhere.begin(), elsewhere.end(), kind) != elsewhere.end()) continue;
    const auto handler = handlers.find(kind);
    if (handler == handlers.end()) {
      ADD_FAILURE() << file << ": no test covers the kind '" << kind << "' (id "
                    << v["id"].get<int>() << ")";
      continue;
    }
    check.begin(v);
    handler->second(v, check);
  }
}

}  // namespace farhand::golden
