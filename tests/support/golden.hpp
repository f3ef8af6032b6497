// The 50-digit test vectors: tests/golden, or $FARHAND_GOLDEN_DIR where it is set. Each vector is
// compared by the files' own rule, max|x - ref| <= tol max(1, max|ref|) per array, angles modulo 2
// pi; a kind nobody handles is a failure.
#pragma once

#include <Eigen/Core>
#include <concepts>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace farhand::golden {

// A value of the file. What is not there, or of another type, throws and names it. Its own type,
// since a JSON library's header takes every test that sees it ten seconds to compile.
class Json {
 public:
  const Json& at(const std::string& key) const;
  const Json& operator[](const char* key) const { return at(key); }
  template <std::integral Index>
  const Json& operator[](Index i) const {
    return items_.at(static_cast<std::size_t>(i));
  }
  auto begin() const { return items_.begin(); }
  auto end() const { return items_.end(); }

  bool contains(const std::string& key) const { return members_.count(key) > 0; }
  bool is_null() const { return kind_ == Kind::null; }
  bool is_array() const { return kind_ == Kind::array; }
  operator double()
      const;  // NOLINT(google-explicit-constructor): a vector's members read as numbers
  operator std::vector<int>() const;  // NOLINT(google-explicit-constructor)
  template <typename T>
  T get() const {
    if constexpr (std::is_same_v<T, std::string>)
      return text();
    else
      return static_cast<T>(static_cast<double>(*this));
  }

 private:
  friend struct Reader;
  enum class Kind { null, number, text, array, object };
  const std::string& text() const;

  Kind kind_ = Kind::null;
  double number_ = 0;  // of a truth value 0 or 1
  std::string text_;
  std::vector<Json> items_;
  std::map<std::string, std::size_t> members_;  // of an object: which item
};

// An array of numbers (nested rows are flattened row by row), or one number, as one column.
Eigen::VectorXd column(const Json& j);

// Rows of a matrix one after the other, to compare with column() of a nested array.
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
  ~Checker();
  Checker(const Checker&) = delete;
  Checker& operator=(const Checker&) = delete;

  void begin(const Json& vector);
  void values(const char* what, const Eigen::VectorXd& x, const Json& ref, double tol);
  void angles(const char* what, const Eigen::VectorXd& x, const Json& ref, double tol);
  void value(const char* what, double x, const Json& ref, double tol);
  void angle(const char* what, double x, const Json& ref, double tol);
  const std::string& where() const { return where_; }

 private:
  struct Kind {
    int vectors = 0;
    double worst = 0;
  };
  void compare(const char* what, const Eigen::VectorXd& x, const Eigen::VectorXd& ref, double tol,
               bool modulo);

  std::string file_, kind_, where_;
  std::map<std::string, Kind> kinds_;
};

using Handlers = std::map<std::string, std::function<void(const Json& vector, Checker& check)>>;

// Runs every vector of the file through the handler of its kind. `elsewhere` names kinds another
// test program handles.
void run(const std::string& file, const Handlers& handlers,
         const std::vector<std::string>& elsewhere = {});

}  // namespace farhand::golden
