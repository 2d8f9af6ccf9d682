// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/foreign_logs/log_tables.hpp"

#include <algorithm>
#include <stdexcept>

#include "gatefly/files/text.hpp"
#include "gatefly/flight_log/foreign_logs/stamps.hpp"

namespace gatefly::foreign_logs {
namespace {

using std::chrono::nanoseconds;

/// Names before they fill the screen.
std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 300;
  return files::one_line(files::joined(names), kMost);
}

}  // namespace

LogTables::LogTables(const Mapping& mapping, const std::filesystem::path& log)
    : mapping_{mapping}, log_{log} {
  std::error_code error;
  const bool is_folder = std::filesystem::is_directory(log, error);
  if (!is_folder && !std::filesystem::exists(log, error))
    throw std::runtime_error(log.string() + ": is not there");
  const bool wants_folder = mapping.kind == Mapping::Kind::kFolder;
  if (is_folder != wants_folder)
    throw std::runtime_error(log.string() + ": is " + (is_folder ? "a folder" : "a file") + ", " +
                             mapping.file.string() + " is about a " +
                             (wants_folder ? "folder" : "file"));
  if (mapping.kind != Mapping::Kind::kUlog) {
    if (csv(mapping.table) == nullptr)
      throw std::runtime_error(name_of(mapping.table) + ": is not there");
    return;
  }
  try {
    ulog_.emplace(files::read_file(log));
  } catch (const UlogError& what) {
    throw std::runtime_error(log.string() + ": " + what.what());
  }
  if (ulog_->topic(mapping.table) == nullptr)
    throw std::runtime_error(log.string() + ": has no topic " + mapping.table +
                             " (there are: " + listed(ulog_->topics()) + ")");
}

const files::Csv* LogTables::csv(const std::string& table) {
  if (const auto found = files_.find(table); found != files_.end()) return found->second.get();
  const std::filesystem::path file = table.empty() ? log_ : log_ / table;
  std::error_code error;
  auto& read = files_[table];
  if (std::filesystem::exists(file, error)) read = std::make_unique<files::Csv>(file);
  return read.get();
}

std::string LogTables::name_of(const std::string& table) const {
  if (table.empty()) return log_.string();
  return mapping_.kind == Mapping::Kind::kUlog ? log_.string() + ", " + table
                                               : (log_ / table).string();
}

std::string LogTables::place(const std::string& table, std::size_t row) {
  if (const files::Csv* const file = ulog_ ? nullptr : csv(table)) return file->place(row);
  return name_of(table) + ", message " + std::to_string(row + 1);
}

bool LogTables::has(const std::string& table, const std::string& column) {
  if (!ulog_) {
    const files::Csv* const file = csv(table);
    return file != nullptr && file->has(column);
  }
  const Ulog::Topic* const topic = ulog_->topic(table);
  return topic != nullptr && ulog_->field(*topic, column) != nullptr;
}

std::string LogTables::columns_of(const std::string& table) {
  if (!ulog_) {
    const files::Csv* const file = csv(table);
    return file == nullptr ? "no such file" : "there are: " + listed(file->header());
  }
  const Ulog::Topic* const topic = ulog_->topic(table);
  return topic == nullptr ? "no such topic; there are: " + listed(ulog_->topics())
                          : "there are: " + listed(ulog_->fields(*topic));
}

std::vector<nanoseconds> LogTables::times(const std::string& table) {
  const TimeColumns* chosen = nullptr;
  for (const TimeColumns& time : mapping_.time) {
    const auto is_there = [&](const std::string& column) { return has(table, column); };
    if (chosen == nullptr && std::all_of(time.columns.begin(), time.columns.end(), is_there))
      chosen = &time;
  }
  if (chosen == nullptr)
    throw std::runtime_error(name_of(table) + ": has no column '" +
                             mapping_.time.front().columns.front() + "' for the time (" +
                             columns_of(table) + ")");
  std::vector<nanoseconds> times;
  for (std::size_t i = 0; i < chosen->columns.size(); ++i) {
    const std::string &column = chosen->columns[i], &unit = chosen->units[i];
    std::vector<std::string> texts;
    if (ulog_) {
      const Ulog::Topic& topic = *ulog_->topic(table);
      const Ulog::Field& field = *ulog_->field(topic, column);
      for (std::size_t row = 0; row < topic.messages.size(); ++row)
        texts.push_back(std::to_string(ulog_->whole(topic, field, row)));
    } else {
      texts = csv(table)->texts(column);
    }
    times.resize(texts.size());
    for (std::size_t row = 0; row < texts.size(); ++row) {
      std::string_view text = texts[row];
      text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
      const auto stamp = stamp_in(text, unit);
      if (!stamp || (ulog_ && *stamp < nanoseconds{0}))
        throw std::runtime_error(place(table, row) + ": " + column + " = '" +
                                 files::one_line(texts[row]) + "' is no time");
      times[row] += *stamp;
    }
  }
  for (std::size_t row = 1; row < times.size(); ++row)
    if (times[row] < times[row - 1])
      throw std::runtime_error(place(table, row) + ": time runs backwards");
  return times;
}

std::vector<double> LogTables::numbers(const std::string& table, const std::string& column) {
  if (!ulog_) return csv(table)->numbers(column);
  const Ulog::Topic& topic = *ulog_->topic(table);
  const Ulog::Field& field = *ulog_->field(topic, column);
  std::vector<double> numbers(topic.messages.size());
  for (std::size_t row = 0; row < numbers.size(); ++row)
    numbers[row] = ulog_->number(topic, field, row);
  return numbers;
}

std::string LogTables::note() const {
  return ulog_ && ulog_->cut()
             ? log_.string() + ": ends within a message (power off?), read up to it"
             : "";
}

}  // namespace gatefly::foreign_logs
