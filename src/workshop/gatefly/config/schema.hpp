// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

namespace gatefly::config {

inline constexpr double kMilliseconds = 1e-3;  ///< The unit of a key in milliseconds [s].

/// Meaning, allowed values and source of the default of a configuration key.
struct KeyRule {
  enum class Kind { kNumber, kInteger, kNumbers, kNumberOrList, kText, kFile };
  std::string name;                       ///< "section.key", the unit at its end.
  double low = 0.0, high = 0.0;           ///< Bounds of every number, in the key's unit, included.
  std::string what = {};                  ///< In a few words.
  std::string source = {};                ///< Origin of the default.
  std::vector<std::string> choices = {};  ///< Allowed words of a text.
  Kind kind = Kind::kNumber;
  std::size_t count = 1;  ///< Length of a list; the most of kNumberOrList.
  bool whole = false;     ///< Only whole numbers in a list.
};

/// `value` if the rule allows it. @throws std::runtime_error "where: key = value, must be ...".
[[nodiscard]] nlohmann::json checked(const KeyRule& rule, const nlohmann::json& value,
                                     const std::string& where);

/// The unit that a key's name ends in: "deg", "px", "m/s", ...; "" when it has none.
[[nodiscard]] std::string unit_of(const std::string& key);

/// A key of a `Target` and the member behind it.
template <class Target>
struct Key {
  KeyRule rule;
  std::function<nlohmann::json(const Target&)> get;         ///< In the key's unit.
  std::function<void(Target&, const nlohmann::json&)> set;  ///< With a value that was checked.
};

/// The number with the fewest digits that times `unit` is `si` again: 5 degrees come back as 5, and
/// what was written and read again is the same to the bit.
[[nodiscard]] double in_unit(double si, double unit);

/// The member behind a key, of a target that is only read: the functions below are written for one that changes.
template <class Target, class Type>
const Type& read_member(Type& (*member)(Target&), const Target& target) {
  return member(const_cast<Target&>(target));
}

/// A key of `rule` whose member `member(target)` yields by reference: a number or a vector. Compiled once a type of
/// member, not once a key.
/// @param unit  SI value of the key's unit: kDegree, 1e-3, ...
template <class Target, class Type>
Key<Target> key_of_member(KeyRule rule, Type& (*member)(Target&), double unit) {
  using nlohmann::json;
  Key<Target> result{std::move(rule), {}, {}};
  if constexpr (std::is_same_v<Type, double>) {
    result.get = [=](const Target& t) { return json(in_unit(read_member(member, t), unit)); };
    result.set = [=](Target& t, const json& v) { member(t) = v.get<double>() * unit; };
  } else if constexpr (std::is_same_v<Type, int>) {
    result.rule.kind = KeyRule::Kind::kInteger;
    result.get = [=](const Target& t) { return json(read_member(member, t)); };
    result.set = [=](Target& t, const json& v) { member(t) = v.get<int>(); };
  } else if constexpr (std::is_same_v<Type, bool>) {  // 0 or 1
    result.rule.kind = KeyRule::Kind::kInteger;
    result.get = [=](const Target& t) { return json(read_member(member, t) ? 1 : 0); };
    result.set = [=](Target& t, const json& v) { member(t) = v.get<int>() != 0; };
  } else {
    result.rule.kind = KeyRule::Kind::kNumbers;
    result.rule.count = static_cast<std::size_t>(Type::RowsAtCompileTime);
    result.get = [=](const Target& t) {
      json list = json::array();
      for (const double x : read_member(member, t)) list.push_back(in_unit(x, unit));
      return list;
    };
    result.set = [=](Target& t, const json& v) {
      for (std::size_t i = 0; i < v.size(); ++i)
        member(t)[static_cast<Eigen::Index>(i)] = v[i].get<double>() * unit;
    };
  }
  return result;
}

/// key_of_member() of a lambda without captures.
template <class Target, class Member>
Key<Target> key(std::string name, double low, double high, Member member, std::string what,
                std::string source, double unit = 1.0) {
  using Type = std::decay_t<decltype(member(std::declval<Target&>()))>;
  Type& (*const function)(Target&) = member;
  return key_of_member(KeyRule{.name = std::move(name),
                               .low = low,
                               .high = high,
                               .what = std::move(what),
                               .source = std::move(source)},
                       function, unit);
}

/// A key whose member is one of a few words.
template <class Target>
Key<Target> choice(std::string name, std::vector<std::string> choices,
                   std::string& (*member)(Target&), std::string what, std::string source) {
  Key<Target> result;
  result.rule = {.name = std::move(name),
                 .what = std::move(what),
                 .source = std::move(source),
                 .choices = std::move(choices),
                 .kind = KeyRule::Kind::kText};
  result.get = [=](const Target& t) { return nlohmann::json(read_member(member, t)); };
  result.set = [=](Target& t, const nlohmann::json& v) { member(t) = v.get<std::string>(); };
  return result;
}

/// A key whose member is the name of a file, or "" for none.
template <class Target>
Key<Target> file_name(std::string name, std::string& (*member)(Target&), std::string what,
                      std::string source) {
  Key<Target> result =
      choice<Target>(std::move(name), {}, member, std::move(what), std::move(source));
  result.rule.kind = KeyRule::Kind::kFile;
  return result;
}

}  // namespace gatefly::config
