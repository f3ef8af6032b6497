#include "common/scene_outline.hpp"

#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include <algorithm>
#include <array>
#include <cstdint>

namespace farhand {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::io::Tokenizer;

using Token = Tokenizer::Token;

ScenePosition position(const Token& t) {
  return {t.line + 1, t.column + 1};
}

// Protobuf's parser reports what the tokenizer minds; here it is only read.
struct Silent : google::protobuf::io::ErrorCollector {
  void AddError(int, int, const std::string&) override {}
};

bool is_number(const Token& t) {
  const std::string word = lower(t.text);
  return t.type == Tokenizer::TYPE_INTEGER || t.type == Tokenizer::TYPE_FLOAT || word == "nan" ||
         word == "inf" || word == "infinity";
}

bool is_truth(const Token& t) {
  constexpr std::array<std::string_view, 8> kWords = {"true",  "True",  "t", "1",
                                                      "false", "False", "f", "0"};
  return std::find(kWords.begin(), kWords.end(), t.text) != kWords.end();
}

// A whole number that fits in 64 bits.
std::optional<std::uint64_t> whole(const Token& t) {
  std::uint64_t value = 0;
  if (t.type != Tokenizer::TYPE_INTEGER || !Tokenizer::ParseInteger(t.text, UINT64_MAX, &value))
    return {};
  return value;
}

bool names_a_value(const google::protobuf::EnumDescriptor& values, const Token& t) {
  const auto index = whole(t);
  return index ? *index < INT32_MAX && values.FindValueByNumber(static_cast<int>(*index)) != nullptr
               : values.FindValueByName(t.text) != nullptr;
}

bool fits(const FieldDescriptor& field, const Token& t, bool negative) {
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return t.text == "{" || t.text == "<";
    case FieldDescriptor::CPPTYPE_STRING:
      return t.type == Tokenizer::TYPE_STRING;
    case FieldDescriptor::CPPTYPE_BOOL:
      return !negative && is_truth(t);
    case FieldDescriptor::CPPTYPE_ENUM:
      return !negative && names_a_value(*field.enum_type(), t);
    case FieldDescriptor::CPPTYPE_UINT64:
      return !negative && whole(t);
    default:
      return is_number(t);
  }
}

class Walk {
 public:
  // With the tokens of protobuf's text format.
  Walk(const std::string& text, SceneOutline& out)
      : stream_(text.data(), static_cast<int>(text.size())),
        tokenizer_(&stream_, &silent_),
        out_(out) {
    tokenizer_.set_comment_style(Tokenizer::SH_COMMENT_STYLE);
    tokenizer_.set_allow_f_after_float(true);
    tokenizer_.set_require_space_after_number(false);
    tokenizer_.set_allow_multiline_strings(true);
    next();
  }

  // Up to the closing symbol, or to the end when it is empty.
  void message(const Descriptor& type, const std::string& path, std::string_view closing,
               ScenePosition opened = {}) {
    Chosen chosen;
    while (!over()) {
      if (!closing.empty() && take(closing)) return;
      if (!separator()) field(type, path, chosen);
    }
    if (!closing.empty() && !out_.fault)
      fault(opened, path, "is opened here and never closed",
            "add a '" + std::string(closing) + "'");
  }

 private:
  using Chosen = std::map<const google::protobuf::OneofDescriptor*, std::string>;

  const Token& token() { return tokenizer_.current(); }
  bool end() { return token().type == Tokenizer::TYPE_END; }
  bool over() { return end() || out_.fault; }
  void next() { tokenizer_.Next(); }
  bool take(std::string_view symbol) {
    if (token().type != Tokenizer::TYPE_SYMBOL || token().text != symbol) return false;
    next();
    return true;
  }
  bool separator() { return take(",") || take(";"); }

  void fault(ScenePosition at, const std::string& path, std::string what, std::string remedy) {
    out_.fault = {path, std::move(what), std::move(remedy)};
    out_.fault_position = at;
  }

  void field(const Descriptor& type, const std::string& path, Chosen& chosen) {
    const Token name = token();
    const FieldDescriptor* found = type.FindFieldByName(name.text);
    if (found == nullptr) return unknown(type, path, name);
    next();
    const std::string here = child(path, name.text);
    if (!found->is_repeated() && out_.positions.contains(here))
      return fault(position(name), here, "given twice", "give it once");
    if (const auto* oneof = found->containing_oneof()) {
      const auto [other, first] = chosen.try_emplace(oneof, name.text);
      if (!first)
        return fault(position(name), here,
                     other->second + " is already chosen as the " + oneof->name(),
                     "keep one of the two");
    }
    out_.positions.try_emplace(here, position(name));
    values(*found, here, name);
  }

  void values(const FieldDescriptor& field, const std::string& path, const Token& name) {
    const bool colon = take(":");
    if (!field.is_repeated()) return value(field, path, name, colon);
    int& count = counts_[path];
    if (!take("[")) return value(field, element(path, count++), name, colon);
    while (!over() && !take("]"))
      if (!take(",")) value(field, element(path, count++), token(), colon);
  }

  // Recorded: the value's own position for numbers and words, the name's for a message that follows
  // its name.
  void value(const FieldDescriptor& field, const std::string& path, const Token& name, bool colon) {
    const Token first = token();
    const bool negative = take("-");
    const bool nested = field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
    if (!fits(field, token(), negative))
      return fault(position(first), path,
                   end() ? "has no value" : "cannot be '" + spelt(negative) + "'",
                   meant(field) + "give " + legal_value(field));
    if (!nested && !colon)
      return fault(position(name), path, "has no ':' after its name",
                   "write " + field.name() + ": " + spelt(negative));
    out_.positions[path] = nested ? position(name) : position(first);
    const std::string_view closing = token().text == "<" ? ">" : "}";
    next();
    if (nested) return message(*field.message_type(), path, closing, position(name));
    while (token().type == Tokenizer::TYPE_STRING) next();  // adjacent strings are one
  }

  std::string spelt(bool negative) { return (negative ? "-" : "") + shortened(token().text); }

  std::string meant(const FieldDescriptor& field) {
    if (field.cpp_type() != FieldDescriptor::CPPTYPE_ENUM) return "";
    const auto near = nearest(token().text, value_names(*field.enum_type()));
    return near ? "did you mean " + *near + "? " : "";
  }

  void unknown(const Descriptor& type, const std::string& path, const Token& name) {
    if (name.type != Tokenizer::TYPE_IDENTIFIER)
      return fault(position(name), path.empty() ? "scene" : path,
                   "'" + shortened(name.text) + "' stands where a field should begin",
                   "write name: value or name { ... }, and close what is open");
    const auto names = field_names(type);
    const auto near = nearest(name.text, names);
    const std::string knows =
        names.empty() ? type.name() + " has no fields" : type.name() + " knows " + listed(names);
    fault(position(name), child(path, shortened(name.text)), "no such field",
          (near ? "did you mean " + *near + "? " : "") + knows);
  }

  google::protobuf::io::ArrayInputStream stream_;
  Silent silent_;
  Tokenizer tokenizer_;
  SceneOutline& out_;
  std::map<std::string, int> counts_;
};

}  // namespace

SceneOutline outline(const std::string& text, const Descriptor& root) {
  SceneOutline out;
  Walk(text, out).message(root, "", "");
  return out;
}

ScenePosition find(const SceneOutline& outline, std::string_view path) {
  for (;;) {
    const auto found = outline.positions.find(path);
    if (found != outline.positions.end()) return found->second;
    const auto cut = path.find_last_of(".[");
    if (cut == std::string_view::npos) return {};
    path = path.substr(0, cut);
  }
}

std::string field_at(const SceneOutline& outline, ScenePosition at) {
  std::string field = "scene";
  ScenePosition latest;
  for (const auto& [path, position] : outline.positions)
    if (latest <= position && position <= at) field = path, latest = position;
  return field;
}

}  // namespace farhand
