// VTK's own files. Numbers and names are made canonical.
#include <vtkGenericDataObjectReader.h>
#include <vtkXMLGenericDataObjectReader.h>
#include <vtkXMLMultiBlockDataReader.h>

#include "core/text.h"
#include "postproc/importers/importer.h"
#include "postproc/importers/vtk/vtk_output.h"
#include "postproc/importers/vtk/vtk_zones.h"

namespace underbody::postproc {

namespace {

namespace fs = std::filesystem;

bool is_xml(std::string_view head, const fs::path& /*path*/) {
    const std::size_t at = head.find("<VTKFile");
    return at != std::string_view::npos && at < 1024;
}
Field read_xml(const fs::path& path, const ReadOptions& options, core::Progress& progress) {
    if (core::lower_case(path.extension().string()) == ".vtm") {
        return field_from_vtk(path, "VTK XML", output_of<vtkXMLMultiBlockDataReader>(path, progress), options,
                              progress);
    }
    return field_from_vtk(path, "VTK XML", output_of<vtkXMLGenericDataObjectReader>(path, progress), options, progress);
}

bool is_legacy(std::string_view head, const fs::path& /*path*/) { return head.starts_with("# vtk DataFile"); }
Field read_legacy(const fs::path& path, const ReadOptions& options, core::Progress& progress) {
    const auto prepare = [&](vtkGenericDataObjectReader& reader) {
        reader.SetFileName(path.c_str());
        reader.ReadAllScalarsOn();
        reader.ReadAllVectorsOn();
        reader.ReadAllFieldsOn();
    };
    return field_from_vtk(path, "VTK legacy", output_of<vtkGenericDataObjectReader>(path, progress, prepare), options,
                          progress);
}

}  // namespace

Importer vtk_xml_importer() { return {"VTK XML", is_xml, read_xml}; }
Importer vtk_legacy_importer() { return {"VTK legacy", is_legacy, read_legacy}; }

}  // namespace underbody::postproc
