// One input of a fuzzer as a file in memory, given to one importer. Only errors about the input may come out.
#pragma once

#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "postproc/importers/importer.h"

namespace underbody::test {

/// A file in memory, with a name: what has none (memfd_create) HDF5 does not open, it follows links to their names.
class MemoryFile {
public:
    MemoryFile(const std::uint8_t* data, std::size_t size) : descriptor_(::mkstemp(path_.data())) {
        if (descriptor_ < 0 || ::write(descriptor_, data, size) != static_cast<ssize_t>(size)) {
            std::abort();
        }
    }
    ~MemoryFile() {
        ::close(descriptor_);
        ::unlink(path_.c_str());
    }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;
    [[nodiscard]] const std::string& path() const { return path_; }

private:
    std::string path_ = "/dev/shm/underbody-fuzz-XXXXXX";
    int descriptor_;
};

/// Reads the bytes; anything but a core::Error escapes and ends the fuzzer.
inline void feed(const postproc::Importer& importer, const std::uint8_t* data, std::size_t size,
                 const postproc::ReadOptions& options = {}) {
    const MemoryFile file(data, size);
    try {
        (void)importer.read(file.path(), options, core::Progress::none());
    } catch (const core::Error&) {
        // Refused: what a fuzzer's file deserves.
    }
}

}  // namespace underbody::test
