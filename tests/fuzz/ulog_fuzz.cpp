// SPDX-License-Identifier: Apache-2.0
// Any bytes may be a ULog. It may be refused, in one line; of what is taken every field of every message can be read.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "gatefly/flight_log/foreign_logs/stamps.hpp"
#include "gatefly/flight_log/foreign_logs/ulog.hpp"

namespace {

using namespace gatefly::foreign_logs;

void must(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "ulog_fuzz: %s\n", what);
  std::abort();
}

void try_log(const std::string& bytes) {
  try {
    const Ulog log{bytes};
    double sum = 0.0;
    for (const std::string& name : log.topics()) {
      const Ulog::Topic* const topic = log.topic(name);
      must(topic != nullptr && !topic->messages.empty(), "a topic that is listed has messages");
      must(topic->messages.size() == topic->sizes.size(), "each message has a size");
      for (const std::string& part : log.fields(*topic)) {
        const Ulog::Field* const field = log.field(*topic, part);
        must(field != nullptr, "a field that is listed is there");
        for (const std::size_t i : {std::size_t{0}, topic->messages.size() - 1}) {
          sum += log.number(*topic, *field, i);
          must(log.whole(*topic, *field, i) >= -1, "a whole number or none");
        }
      }
    }
    (void)log.topic(bytes);
    (void)sum;
  } catch (const UlogError& error) {
    must(std::string_view{error.what()}.find('\n') == std::string_view::npos,
         "an error is one line");
  }
}

void try_stamp(std::string_view text) {
  for (const char* unit : {"s", "ms", "us", "ns"})
    if (const auto stamp = stamp_in(text, unit))
      must(stamp_in(std::to_string(stamp->count()), "ns") == stamp, "a stamp comes back");
  const std::string found = stamp_of_name(text);
  must(text.find(found) != std::string_view::npos, "a stamp is part of its name");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes{reinterpret_cast<const char*>(data), size};
  try_log(bytes);
  try_log("ULog\x01\x12\x35\x01" + std::string(8, '\1') + bytes);  // behind a header
  if (size < 64) try_stamp(bytes);
  return 0;
}
