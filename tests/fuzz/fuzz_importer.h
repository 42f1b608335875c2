// One input of a fuzzer as a file in memory, given to one importer. Only errors about the input may come out.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "postproc/importers/importer.h"

namespace underbody::test {

/// A file that exists in memory only, with a path that others can open.
class MemoryFile {
public:
    MemoryFile(const std::uint8_t* data, std::size_t size) : descriptor_(::memfd_create("fuzz", 0)) {
        if (descriptor_ < 0 || ::write(descriptor_, data, size) != static_cast<ssize_t>(size)) {
            std::abort();
        }
    }
    ~MemoryFile() { ::close(descriptor_); }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;
    [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

private:
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
