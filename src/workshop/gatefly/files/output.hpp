// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

// The one place where files are opened for writing. What a command will write is checked before it
// works, so that nothing is found out after minutes and nothing of the user's is replaced; what it
// wrote is put in place when it is whole.

namespace gatefly::files {

/// An output that cannot be written: "found.csv: cannot be written: No space left on device".
class CannotWrite : public std::runtime_error {
 public:
  CannotWrite(const std::filesystem::path& path, const std::string& why)
      : std::runtime_error(path.string() + ": cannot be written: " + why), reason{why} {}
  std::string reason;
};

/// Traits that our files of a kind share: only those are replaced without being told to.
struct OutputKind {
  std::string_view name;      ///< "table of detections".
  std::string_view mark;      ///< Each has this text ...
  std::size_t within = 1024;  ///< ... in its first bytes.
};
/// Pictures that a Canvas wrote.
inline constexpr OutputKind kOurPng{"picture of ours", {"Software\0gatefly", 16}};

/// How names of what is not yet whole begin.
inline constexpr std::string_view kAside = ".gatefly";

/// Whether there is such a file, with nothing in it or of this kind.
[[nodiscard]] bool is_of_kind(const std::filesystem::path& path, const OutputKind& kind);

/// A file that the command line names to be written.
struct Output {
  std::string flag;
  std::filesystem::path path;
  OutputKind kind;
};

/// Whether this is standard output: "-", or another name of what it goes to ("/dev/stdout").
[[nodiscard]] bool is_stdout(const std::filesystem::path& path);

/// Refuses outputs that cannot be written, name one of the `inputs` (of a folder: a picture, or what
/// is not of the output's kind), or a file of another kind.
/// @param force  a file of another kind is replaced, an input never
/// @throws std::runtime_error one line.
void check_outputs(std::span<const Output> outputs, std::span<const std::filesystem::path> inputs,
                   bool force);

/// Refuses a folder that cannot be made or written to, leaving nothing behind, or is to be one of
/// the `files`.
/// @throws std::runtime_error one line.
void check_output_folder(const std::string& flag, const std::filesystem::path& folder,
                         std::span<const Output> files = {});

/// Refuses a folder, if it is there and not empty, whose file `marker` is not of `kind`.
void refuse_foreign_folder(const std::filesystem::path& folder, const std::string& marker,
                           const OutputKind& kind, const std::string& way_out);

/// The end of a chain of symbolic links, be it there or not.
[[nodiscard]] std::filesystem::path behind_links(std::filesystem::path path);

struct FileContent {
  std::filesystem::path path;
  std::string content;
};

/// Writes whole files, all or none: each aside, then renamed. What is no regular file (a device, a
/// pipe) is written through, a link keeps pointing, "-" is standard output.
/// @throws CannotWrite naming the file and why.
void write_files(std::span<const FileContent> files);
void write_file(const std::filesystem::path& path, std::string_view content);

}  // namespace gatefly::files
