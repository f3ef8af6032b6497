// The 50-digit test vectors: tests/golden, or $FARHAND_GOLDEN_DIR where it is set. Each vector is
// compared by the files' own rule, max|x - ref| <= tol max(1, max|ref|) per array, angles modulo 2
// pi; a kind nobody handles is a failure.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

namespace farhand::golden {

using Json = nlohmann::json;

inline Json load(const std::string& name) {
  const char* dir = std::getenv("FARHAND_GOLDEN_DIR");
  const std::string path =
      (dir != nullptr ? std::string(dir) : std::string(FARHAND_SOURCE_DIR "/tests/golden")) + "/" +
      name + ".json";
  std::ifstream in(path);
  if (!in) throw std::runtime_error("cannot open golden file " + path);
  return Json::parse(in);
}

// A JSON array of numbers (nested rows are flattened row by row) as one column.
inline Eigen::VectorXd column(const Json& j) {
  std::vector<double> flat;
  const std::function<void(const Json&)> add = [&](const Json& x) {
    if (x.is_array()) {
      for (const auto& y : x) add(y);
    } else {
      flat.push_back(x.get<double>());
    }
  };
  add(j);
  return Eigen::Map<Eigen::VectorXd>(flat.data(), static_cast<Eigen::Index>(flat.size()));
}

// Rows of a matrix one after the other, to compare with column() of a nested JSON array.
template <typename Derived>
Eigen::VectorXd rows(const Eigen::MatrixBase<Derived>& m) {
  Eigen::VectorXd out(m.size());
  for (Eigen::Index i = 0, k = 0; i < m.rows(); ++i)
    for (Eigen::Index j = 0; j < m.cols(); ++j) out[k++] = m(i, j);
  return out;
}

// Collects error/tolerance per kind and reports the worst when it goes.
class Checker {
 public:
  explicit Checker(std::string file) : file_(std::move(file)) {}
  ~Checker() {
    for (const auto& [kind, k] : kinds_)
      std::printf("golden %s/%s: %d vectors, worst error/tolerance %.3g\n", file_.c_str(),
                  kind.c_str(), k.vectors, k.worst);
  }
  Checker(const Checker&) = delete;
  Checker& operator=(const Checker&) = delete;

  void begin(const Json& vector) {
    kind_ = vector.at("kind").get<std::string>();
    where_ = file_ + " id " + vector.at("id").dump() + " (" + kind_ + ", " +
             vector.at("tag").get<std::string>() + ")";
    ++kinds_[kind_].vectors;
  }
  void values(const char* what, const Eigen::VectorXd& x, const Json& ref, double tol) {
    compare(what, x, column(ref), tol, false);
  }
  void angles(const char* what, const Eigen::VectorXd& x, const Json& ref, double tol) {
    compare(what, x, column(ref), tol, true);
  }
  void value(const char* what, double x, const Json& ref, double tol) {
    compare(what, Eigen::VectorXd::Constant(1, x), column(ref), tol, false);
  }
  void angle(const char* what, double x, const Json& ref, double tol) {
    compare(what, Eigen::VectorXd::Constant(1, x), column(ref), tol, true);
  }
  const std::string& where() const { return where_; }

 private:
  struct Kind {
    int vectors = 0;
    double worst = 0;
  };
  void compare(const char* what, const Eigen::VectorXd& x, const Eigen::VectorXd& ref, double tol,
               bool modulo) {
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

  std::string file_, kind_, where_;
  std::map<std::string, Kind> kinds_;
};

using Handlers = std::map<std::string, std::function<void(const Json& vector, Checker& check)>>;

// Runs every vector of the file through the handler of its kind. `elsewhere` names kinds another
// test program handles.
inline void run(const std::string& file, const Handlers& handlers,
                const std::vector<std::string>& elsewhere = {}) {
  const Json all = load(file);
  Checker check(file);
  for (const auto& v : all.at("vectors")) {
    const auto kind = v.at("kind").get<std::string>();
    if (std::find(elsewhere.begin(), elsewhere.end(), kind) != elsewhere.end()) continue;
    const auto handler = handlers.find(kind);
    if (handler == handlers.end()) {
      ADD_FAILURE() << file << ": no test covers the kind '" << kind << "' (id " << v.at("id")
                    << ")";
      continue;
    }
    check.begin(v);
    handler->second(v, check);
  }
}

}  // namespace farhand::golden
