// Files: mapped for reading, written whole.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace underbody::core {

/// A file mapped read-only. Throws InputError if it does not exist, is a folder, or cannot be read.
class MappedFile {
public:
    explicit MappedFile(const std::filesystem::path& path);
    ~MappedFile();
    MappedFile(MappedFile&& other) noexcept;
    MappedFile& operator=(MappedFile&& other) noexcept;
    MappedFile(const MappedFile&) = delete;
    MappedFile& operator=(const MappedFile&) = delete;

    [[nodiscard]] std::string_view bytes() const { return {data_, size_}; }
    [[nodiscard]] const std::string& name() const { return name_; }

private:
    const char* data_ = nullptr;
    std::size_t size_ = 0;
    std::string name_;
};

std::string read_file(const std::filesystem::path& path);

/// Writes under a temporary name in the same folder, syncs, renames: the old file or the new one, never half.
/// Makes missing folders. Throws SystemError (no space, no permission) and leaves nothing behind.
void write_file(const std::filesystem::path& path, std::string_view bytes);

/// For writers that want a file name (VTK, matio, HDF5): write to `path()`, then `commit()`.
/// Without a commit the temporary file is removed. Temporary files of a killed run are named `.NAME.underbody-*`.
class PendingFile {
public:
    explicit PendingFile(std::filesystem::path target);
    ~PendingFile();
    PendingFile(const PendingFile&) = delete;
    PendingFile& operator=(const PendingFile&) = delete;

    /// Has the same ending as the target.
    [[nodiscard]] const std::filesystem::path& path() const { return temporary_; }
    void commit();

private:
    std::filesystem::path target_;
    std::filesystem::path temporary_;
    bool committed_ = false;
};

/// A folder that removes itself.
class TemporaryFolder {
public:
    explicit TemporaryFolder(const std::string& prefix = "underbody");
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

}  // namespace underbody::core
