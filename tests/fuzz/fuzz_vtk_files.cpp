// VTK's own files, surfaces and Tecplot: the ending that the content calls for, and then whatever importer takes it.
#include <cstring>
#include <fstream>

#include "core/file.h"
#include "tests/fuzz/fuzz_importer.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const underbody::core::TemporaryFolder folder;
    const std::string text(reinterpret_cast<const char*>(data), size);
    const char* ending = text.find("vtkMultiBlock") != std::string::npos ? ".vtm"
                         : text.find("<VTKFile") != std::string::npos    ? ".vtu"
                         : text.starts_with("ply")                       ? ".ply"
                         : text.starts_with("solid")                     ? ".stl"
                         : text.starts_with("v ")                        ? ".obj"
                         : text.starts_with("#")                         ? ".vtk"
                                                                         : ".stl";
    const auto path = folder.path() / (std::string("input") + ending);
    std::ofstream(path, std::ios::binary) << text;
    if (const auto* importer = underbody::postproc::importer_for(path)) {
        try {
            (void)importer->read(path, {}, underbody::core::Progress::none());
        } catch (const underbody::core::Error&) {
            // Refused.
        }
    }
    return 0;
}
