// The input is a geometry; the case and a variable that belongs to it stand beside it.
#include <filesystem>
#include <fstream>

#include "core/file.h"
#include "tests/fuzz/fuzz_importer.h"

namespace underbody::postproc {
Importer ensight_importer();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const auto importer = underbody::postproc::ensight_importer();
    static const underbody::core::TemporaryFolder folder;
    static const bool ready = [] {
        const std::filesystem::path from = UNDERBODY_TEST_DATA "/ensight";
        for (const char* name : {"little.encas", "little.scl1", "little.vel"}) {
            std::filesystem::copy_file(from / name, folder.path() / name);
        }
        return true;
    }();
    std::ofstream(folder.path() / "little.geo", std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    try {
        (void)ready;
        (void)importer.read(folder.path() / "little.encas", {}, underbody::core::Progress::none());
    } catch (const underbody::core::Error&) {
        return 0;
    }
    return 0;
}
