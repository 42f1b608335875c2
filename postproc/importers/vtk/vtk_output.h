// What one of VTK's readers makes of a file, once it is sure that the file is no danger to it.
#pragma once

#include <vtkDataObject.h>
#include <vtkErrorCode.h>
#include <vtkSmartPointer.h>

#include <filesystem>

#include "core/error.h"
#include "postproc/importers/linked_files.h"
#include "postproc/importers/sandboxed_read.h"
#include "postproc/importers/vtk/vtk_problems.h"

namespace underbody::postproc {

/// Throws core::InputError where cells name corners that are not there or arrays have another length than what they
/// belong to: VTK's filters trust both.
void check_leaves(const std::filesystem::path& path, vtkDataObject* object);

/// Read in a process of its own first. `prepare` makes a reader ready, file name included; it is called for the trial
/// and for the reading proper.
template <typename Reader, typename Prepare>
vtkSmartPointer<vtkDataObject> output_of(const std::filesystem::path& path, core::Progress& progress,
                                         Prepare&& prepare) {
    note_vtk_pieces(path);
    try_in_child(
        path,
        [&] {
            auto reader = vtkSmartPointer<Reader>::New();
            const VtkProblems problems;
            prepare(*reader);
            reader->Update();
            check_leaves(path, reader->GetOutputDataObject(0));
        },
        progress);
    auto reader = vtkSmartPointer<Reader>::New();
    const VtkProblems problems;
    prepare(*reader);
    reader->Update();
    if (problems.any() || reader->GetErrorCode() != vtkErrorCode::NoError) {
        throw core::InputError("format", "VTK cannot read it: " + problems.first(), {path.string(), {}, {}, {}},
                               "the file is cut short or damaged");
    }
    check_leaves(path, reader->GetOutputDataObject(0));
    return reader->GetOutputDataObject(0);
}

template <typename Reader>
vtkSmartPointer<vtkDataObject> output_of(const std::filesystem::path& path, core::Progress& progress) {
    return output_of<Reader>(path, progress, [&](Reader& reader) { reader.SetFileName(path.c_str()); });
}

}  // namespace underbody::postproc
