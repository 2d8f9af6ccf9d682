// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/output.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "gatefly/files/image_file.hpp"
#include "gatefly/files/printed.hpp"

namespace gatefly::files {
namespace {

namespace fs = std::filesystem;

/// Status of a path's target; nullopt when there is nothing. @throws CannotWrite when nobody can
/// tell.
std::optional<struct stat> status_of(const fs::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0) return status;
  if (errno != ENOENT) throw CannotWrite(path, std::strerror(errno));
  return std::nullopt;
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path{"."};
}

/// A new file in `folder`, whose name nobody has.
int open_aside(const fs::path& folder, fs::path& aside) {
  static std::atomic<int> count{0};  // other threads write, too
  int file = -1;
  do {
    aside = folder /
            (std::string{kAside} + "-" + std::to_string(getpid()) + "-" + std::to_string(count++));
    file = ::open(aside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (file < 0 && errno == EEXIST);
  return file;
}

/// Whether a file can be made there: by making one. @return errno, 0 when it can.
int try_folder(const fs::path& folder) {
  // A signal that ends the program waits until that file is gone.
  sigset_t ending, before;
  sigemptyset(&ending);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&ending, signal);
  pthread_sigmask(SIG_BLOCK, &ending, &before);
  fs::path aside;
  const int file = open_aside(folder, aside);
  const int error = file < 0 ? errno : 0;
  if (file >= 0) {
    ::close(file);
    ::unlink(aside.c_str());
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return error;
}

bool write_all(int file, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(file, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

/// A file on its way: aside until put in place, removed when it never is.
class Pending {
 public:
  explicit Pending(const FileContent& file) : path_{file.path}, content_{file.content} {
    if (is_stdout(path_)) return;
    const auto old = status_of(path_);
    if (old && S_ISDIR(old->st_mode)) throw CannotWrite(path_, std::strerror(EISDIR));
    if (old && !S_ISREG(old->st_mode)) return;
    target_ = behind_links(path_);
    const int aside = open_aside(folder_of(target_), aside_);
    if (aside < 0) fail();
    if (old) {  // owner and permissions stay
      (void)!::fchown(aside, old->st_uid, old->st_gid);
      ::fchmod(aside, old->st_mode & 07777);
    }
    close(aside, write_all(aside, content_));
  }
  ~Pending() {
    if (!aside_.empty()) ::unlink(aside_.c_str());
  }
  Pending(const Pending&) = delete;
  Pending& operator=(const Pending&) = delete;

  [[nodiscard]] bool is_aside() const { return !aside_.empty(); }

  void put_in_place() {
    if (is_stdout(path_)) {
      const AsItIs content;
      if (!std::cout.write(content_.data(), static_cast<std::streamsize>(content_.size())).flush())
        throw CannotWrite("standard output", std::strerror(errno));
    } else if (target_.empty()) {
      const int device = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC);
      if (device < 0) fail();
      close(device, write_all(device, content_));
    } else {
      if (::rename(aside_.c_str(), target_.c_str()) != 0) fail();
      aside_.clear();
    }
  }

 private:
  void close(int file, bool written) {
    const int reason = written ? 0 : errno;
    if (::close(file) == 0 && written) return;
    if (reason != 0) errno = reason;
    fail();
  }
  [[noreturn]] void fail() {
    const int reason = errno;
    if (!aside_.empty()) ::unlink(aside_.c_str());  // the destructor of what is not made never runs
    throw CannotWrite(path_, std::strerror(reason));
  }

  fs::path path_, target_, aside_;  ///< target_: behind its links; empty when written through.
  std::string_view content_;
};

bool is_same(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return fs::equivalent(a, b, error) && !error;
}

/// Also where there is nothing yet, whatever it is to be.
bool is_same_place(const fs::path& a, const fs::path& b) {
  const auto place = [](const fs::path& path) {
    const fs::path whole = fs::weakly_canonical(fs::absolute(behind_links(path)));
    return whole.has_filename() ? whole : whole.parent_path();  // "drawn/" is "drawn"
  };
  return place(a) == place(b);
}

void refuse_inputs(const Output& output, std::span<const fs::path> inputs) {
  const std::string named = output.flag + " " + output.path.string() + ": would overwrite ";
  for (const fs::path& input : inputs) {
    if (is_same(output.path, input))
      throw std::runtime_error(named + "the input " + input.string());
    if (is_same(folder_of(behind_links(output.path)), input) &&
        (is_picture(output.path) || !is_of_kind(output.path, output.kind)))
      throw std::runtime_error(named + "a file of the input " + input.string());
  }
}

void check_output(const Output& output, std::span<const fs::path> inputs, bool force) {
  const fs::path named = output.flag + " " + output.path.string();
  const auto there = [&] {
    try {
      return status_of(output.path);
    } catch (const CannotWrite& error) {
      throw CannotWrite(named, error.reason);
    }
  }();
  if (there && S_ISCHR(there->st_mode)) return;
  if (there && (S_ISDIR(there->st_mode) || S_ISBLK(there->st_mode) || S_ISSOCK(there->st_mode)))
    throw CannotWrite(named, std::string{S_ISDIR(there->st_mode)   ? "is a folder"
                                         : S_ISBLK(there->st_mode) ? "is a disk"
                                                                   : "is a socket"} +
                                 ", must be a file");
  if (there) refuse_inputs(output, inputs);
  if (there && ::access(output.path.c_str(), W_OK) != 0)
    throw CannotWrite(named, std::strerror(errno));
  if (there && S_ISREG(there->st_mode) && !force && !is_of_kind(output.path, output.kind))
    throw std::runtime_error(named.string() + ": is there and is no " +
                             std::string{output.kind.name} +
                             "; choose another name (--force replaces it)");
  if (there && !S_ISREG(there->st_mode)) return;
  const int error = try_folder(folder_of(behind_links(output.path)));
  if (error == ENOENT && !fs::is_directory(folder_of(behind_links(output.path))))
    throw CannotWrite(named, "must be a file in a folder that is there");
  if (error != 0) throw CannotWrite(named, std::strerror(error));
}

}  // namespace

fs::path behind_links(fs::path path) {
  constexpr int kMostLinks = 40;  // as many as the system follows
  std::error_code error;
  for (int i = 0; i < kMostLinks && fs::is_symlink(path, error); ++i)
    path = path.parent_path() / fs::read_symlink(path, error);
  return path;
}

bool is_of_kind(const fs::path& path, const OutputKind& kind) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return false;
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) return false;
  std::string start(static_cast<std::size_t>(std::min<std::uintmax_t>(size, kind.within)), '\0');
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  return size == 0 || start.find(kind.mark) != std::string::npos;
}

bool is_stdout(const fs::path& path) {
  if (path == "-") return true;
  struct stat a {
  }, b{};
  return ::stat(path.c_str(), &a) == 0 && ::fstat(STDOUT_FILENO, &b) == 0 && a.st_dev == b.st_dev &&
         a.st_ino == b.st_ino;
}

void check_outputs(std::span<const Output> outputs, std::span<const fs::path> inputs, bool force) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const Output& output = outputs[i];
    const auto same = [&](const Output& other) {
      return is_stdout(output.path) ? is_stdout(other.path)
                                    : is_same_place(output.path, other.path);
    };
    const auto before = outputs.subspan(0, i);
    const auto twin = std::find_if(before.begin(), before.end(), same);
    if (twin != before.end())
      throw std::runtime_error(output.flag + " " + output.path.string() + ": is where " +
                               twin->flag + " goes, too");
    if (!is_stdout(output.path)) check_output(output, inputs, force);
  }
}

void check_output_folder(const std::string& flag, const fs::path& folder,
                         std::span<const Output> files) {
  const fs::path named = flag + " " + folder.string();
  if (folder == "-") throw CannotWrite(named, "must be a folder, not standard output");
  for (const Output& file : files)
    if (!file.path.empty() && is_same_place(folder, file.path))
      throw std::runtime_error(named.string() + ": is where " + file.flag + " goes, too");
  std::error_code error;
  fs::path there = fs::absolute(behind_links(folder));
  while (!fs::exists(there, error) && there.has_relative_path()) there = there.parent_path();
  if (!fs::is_directory(there, error))
    throw CannotWrite(named, there.string() + " is there and is no folder");
  if (const int reason = try_folder(there)) throw CannotWrite(named, std::strerror(reason));
}

void refuse_foreign_folder(const fs::path& folder, const std::string& marker,
                           const OutputKind& kind, const std::string& way_out) {
  std::error_code error;
  if (!fs::exists(folder, error)) return;
  if (!fs::is_directory(folder, error))
    throw std::runtime_error(folder.string() + ": is there and is no folder, " + way_out);
  const bool empty = std::all_of(
      fs::directory_iterator(folder, error), fs::directory_iterator{}, [](const auto& entry) {
        return entry.path().filename().string().starts_with(kAside);  // a killed program's
      });
  if (!empty && !is_of_kind(folder / marker, kind))
    throw std::runtime_error(folder.string() + ": is there and holds no " + std::string{kind.name} +
                             " (" + marker + "), " + way_out);
}

void write_files(std::span<const FileContent> files) {
  std::vector<std::unique_ptr<Pending>> pending;
  for (const FileContent& file : files) pending.push_back(std::make_unique<Pending>(file));
  // Streams and devices first: only they can still fail, and then nothing has changed.
  std::stable_partition(pending.begin(), pending.end(),
                        [](const auto& file) { return !file->is_aside(); });
  for (const auto& file : pending) file->put_in_place();
}

void write_file(const fs::path& path, std::string_view content) {
  const FileContent file{path, std::string{content}};
  write_files({&file, 1});
}

}  // namespace gatefly::files
