// Zones of the VTK files that we wrote ourselves, apart again as they were before.
#pragma once

#include <vtkDataSet.h>

#include <vector>

#include "postproc/field/vtk_description.h"

namespace underbody::postproc {

/// A zone with its part of the data; `as_written` false: somebody changed points or cells since.
struct ZonePart {
    Zone zone;
    vtkSmartPointer<vtkDataSet> data;
    bool as_written = false;
};

/// Parts of the data by the marks of their cells (cells of no known mark become one zone more); empty when the
/// description has several zones and the cells have no marks any more. What it describes as a surface comes out as one
/// where its cells allow that. Field data that belongs to the description is taken away.
std::vector<ZonePart> parts_of(vtkDataSet& data, const Description& description);

}  // namespace underbody::postproc
