// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/partial_folder.hpp"

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace gatefly::files {

namespace fs = std::filesystem;

namespace {

constexpr const char* kReplaced = ".replaced";  // the folder that was there, while we change places

bool is_same_file(int file, const fs::path& path) {
  struct stat a {
  }, b{};
  return ::fstat(file, &a) == 0 && ::stat(path.c_str(), &b) == 0 && a.st_dev == b.st_dev &&
         a.st_ino == b.st_ino;
}

/// Nothing can take the place of a mount point.
bool is_mount_point(const fs::path& folder) {
  struct stat a {
  }, b{};
  return ::stat(folder.c_str(), &a) == 0 && ::stat((folder / "..").c_str(), &b) == 0 &&
         a.st_dev != b.st_dev;
}

std::vector<fs::path> entries_of(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) entries.push_back(entry.path());
  return entries;
}

/// "out/a/" is "out/a".
fs::path without_slash(fs::path path) {
  while (path.has_relative_path() && !path.has_filename()) path = path.parent_path();
  return path;
}

}  // namespace

PartialFolder::PartialFolder(fs::path out, Grows grows, IsOurs is_ours)
    : out_{without_slash(std::move(out))},
      place_{without_slash(behind_links(out_))},
      partial_{grows == Grows::kBeside ? fs::path{place_.string() + ".partial"}
                                       : place_ / (std::string{kAside} + ".partial")},
      is_ours_{std::move(is_ours)} {
  if (grows == Grows::kBeside && is_mount_point(place_))
    fail("is a mount point, choose a folder in it");
  std::error_code error;
  for (fs::path above = partial_.parent_path(); !above.empty() && !fs::exists(above, error);
       above = above.parent_path())
    made_.push_back(above);
  fs::create_directories(partial_, error);
  if (error) fail(error.message());
  lock();
  try {
    clear_leftovers();
    const fs::file_status old = fs::status(place_, error);
    if (grows == Grows::kBeside && fs::is_directory(old))
      fs::permissions(partial_, old.permissions(), error);
  } catch (...) {
    ::close(lock_);
    throw;
  }
}

PartialFolder::~PartialFolder() {
  if (!kept_ && is_same_file(lock_, partial_)) {
    std::error_code ignored;
    remove_ours(partial_);
    fs::remove(partial_, ignored);
    for (const fs::path& folder : made_) fs::remove(folder, ignored);  // empty ones only
  }
  ::close(lock_);
}

/// The system lets go of it when the program ends, however it ends.
void PartialFolder::lock() {
  lock_ = ::open(partial_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (lock_ < 0) throw CannotWrite(partial_, std::strerror(errno));
  const bool taken = ::flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  if (!taken && is_same_file(lock_, partial_)) return;
  ::close(lock_);
  fail("another gatefly is writing it now");
}

void PartialFolder::clear_leftovers() {
  for (const fs::path& entry : entries_of(partial_))
    if (!is_ours_(entry.filename().string()) || fs::is_directory(fs::symlink_status(entry)))
      throw std::runtime_error(partial_.string() + ": is there and holds " +
                               entry.filename().string() +
                               ", which no interrupted run left; move it away");
  remove_ours(partial_);
}

void PartialFolder::remove_ours(const fs::path& folder) const {
  std::error_code ignored;
  for (const fs::path& entry : entries_of(folder))
    if (is_ours_(entry.filename().string())) fs::remove(entry, ignored);
}

void PartialFolder::write(const std::string& name, std::string_view content) const try {
  write_file(partial_ / name, content);
} catch (const CannotWrite& error) {
  throw CannotWrite(out_ / name, error.reason);
}

void PartialFolder::replace(const IsOurs& keep) {
  const fs::path old = partial_ / kReplaced;
  std::error_code error;
  const bool was_there = fs::exists(place_, error);
  if (was_there) fs::rename(place_, old, error);
  if (error) fail(error.message());
  fs::rename(partial_, place_, error);
  if (error) {
    std::error_code ignored;
    if (was_there) fs::rename(old, place_, ignored);
    fail(error.message());
  }
  if (!was_there) return;
  const fs::path rest = place_ / kReplaced;
  for (const fs::path& entry : entries_of(rest)) {
    const std::string name = entry.filename().string();
    if (is_ours_(name) && !keep(name))
      fs::remove(entry, error);
    else
      fs::rename(entry, place_ / name, error);
  }
  fs::remove(rest, error);
}

void PartialFolder::pour() {
  std::error_code error;
  const std::vector<fs::path> entries = entries_of(partial_);
  for (const fs::path& entry : entries)
    if (fs::is_directory(place_ / entry.filename(), error))
      throw CannotWrite(out_ / entry.filename(), "is a folder");
  for (const fs::path& entry : entries) {
    fs::rename(entry, place_ / entry.filename(), error);
    if (error) throw CannotWrite(out_ / entry.filename(), error.message());
  }
}

}  // namespace gatefly::files
