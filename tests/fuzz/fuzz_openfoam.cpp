// The first byte says which file of a case that is whole otherwise the rest of the input replaces.
#include <array>
#include <filesystem>
#include <fstream>

#include "core/file.h"
#include "tests/fuzz/fuzz_importer.h"

namespace underbody::postproc {
Importer openfoam_importer();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    namespace fs = std::filesystem;
    static const auto importer = underbody::postproc::openfoam_importer();
    static const underbody::core::TemporaryFolder folder;
    static constexpr std::array files = {"constant/polyMesh/points",
                                         "constant/polyMesh/faces",
                                         "constant/polyMesh/owner",
                                         "constant/polyMesh/neighbour",
                                         "constant/polyMesh/boundary",
                                         "0.005/p",
                                         "0.005/U"};
    static const bool ready = [] {
        fs::copy(fs::path(UNDERBODY_TEST_DATA) / "openfoam" / "binary", folder.path() / "box",
                 fs::copy_options::recursive);
        return true;
    }();
    if (!ready || size < 2) {
        return 0;
    }
    const fs::path target = folder.path() / "box" / files[data[0] % files.size()];
    const std::string whole = underbody::core::read_file(target);
    std::ofstream(target, std::ios::binary)
        .write(reinterpret_cast<const char*>(data + 1), static_cast<std::streamsize>(size - 1));
    try {
        (void)importer.read(folder.path() / "box", {}, underbody::core::Progress::none());
    } catch (const underbody::core::Error&) {
        // Refused.
    }
    std::ofstream(target, std::ios::binary) << whole;
    return 0;
}
