// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "gatefly/files/output.hpp"

namespace gatefly::files {

/// New content of a folder `out`: it grows aside, for one program at a time, and is put in place when
/// it is whole; until then nothing that is in `out` changes, and what never is whole goes.
class PartialFolder {
 public:
  /// Whether a file of this name is the program's: others are never removed.
  using IsOurs = std::function<bool(const std::string& name)>;

  /// Beside `out` in `<out>.partial`, to take its place; or inside, to be added to it.
  enum class Grows { kBeside, kInside };

  /// Clears away the remains of a killed program.
  /// @throws std::runtime_error when it cannot be written, is somebody else's, or another program is
  ///     at it.
  PartialFolder(std::filesystem::path out, Grows grows, IsOurs is_ours);
  ~PartialFolder();
  PartialFolder(const PartialFolder&) = delete;
  PartialFolder& operator=(const PartialFolder&) = delete;

  /// Place for files that somebody else writes.
  [[nodiscard]] const std::filesystem::path& path() const { return partial_; }
  /// @throws CannotWrite naming the file where it will be.
  void write(const std::string& name, std::string_view content) const;

  /// Becomes `out`. Of the folder that was there, what is not ours moves in.
  /// @param keep  what of ours stays, too
  void replace(const IsOurs& keep);
  /// Leaves the written files where they are, e.g. when they cannot take their place.
  void keep() { kept_ = true; }
  /// Moves every file into `out`, over those of its name.
  void pour();

 private:
  void lock();
  void clear_leftovers();
  void remove_ours(const std::filesystem::path& folder) const;
  [[noreturn]] void fail(const std::string& why) const { throw CannotWrite(out_, why); }

  std::filesystem::path out_, place_, partial_;  ///< place_: behind the links of out_.
  IsOurs is_ours_;
  std::vector<std::filesystem::path> made_;  ///< Folders above, innermost first.
  int lock_ = -1;
  bool kept_ = false;
};

}  // namespace gatefly::files
