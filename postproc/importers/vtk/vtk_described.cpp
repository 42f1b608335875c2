#include "postproc/importers/vtk/vtk_described.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkExtractCells.h>
#include <vtkFieldData.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>
#include <map>
#include <numeric>

namespace underbody::postproc {

namespace {

/// Which list of a surface a cell belongs to: 0 points, 1 lines, 2 faces; 3 none of them.
int list_of(int type) {
    switch (type) {
        case VTK_VERTEX:
        case VTK_POLY_VERTEX:
            return 0;
        case VTK_LINE:
        case VTK_POLY_LINE:
            return 1;
        case VTK_TRIANGLE:
        case VTK_QUAD:
        case VTK_POLYGON:
            return 2;
        default:
            return 3;
    }
}

void copy_tuples(vtkDataSetAttributes& from, vtkIdList& which, vtkDataSetAttributes& to) {
    for (int i = 0; i < from.GetNumberOfArrays(); ++i) {
        vtkAbstractArray* whole = from.GetAbstractArray(i);
        auto part = vtk::TakeSmartPointer(whole->NewInstance());
        part->SetName(whole->GetName());
        part->SetNumberOfComponents(whole->GetNumberOfComponents());
        part->SetNumberOfTuples(which.GetNumberOfIds());
        whole->GetTuples(&which, part);
        to.AddArray(part);
    }
}

/// Points from `first` on, `count` of them, when the cells need no others; else those that they need.
std::vector<vtkIdType> points_for(vtkDataSet& data, const std::vector<vtkIdType>& cells, vtkIdType first,
                                  vtkIdType count) {
    vtkNew<vtkIdList> nodes;
    std::vector<vtkIdType> used;
    for (const vtkIdType cell : cells) {
        data.GetCellPoints(cell, nodes);
        used.insert(used.end(), nodes->begin(), nodes->end());
    }
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    if (count > 0 && first + count <= data.GetNumberOfPoints() &&
        (used.empty() || (used.front() >= first && used.back() < first + count))) {
        used.resize(static_cast<std::size_t>(count));
        std::iota(used.begin(), used.end(), first);
    }
    return used;
}

vtkSmartPointer<vtkPolyData> surface_from(vtkDataSet& data, std::vector<vtkIdType> cells, vtkIdType first,
                                          vtkIdType count) {
    const std::vector<vtkIdType> points = points_for(data, cells, first, count);
    auto surface = vtkSmartPointer<vtkPolyData>::New();
    auto places = vtkSmartPointer<vtkPoints>::New();
    places->SetDataType(VTK_DOUBLE);
    vtkNew<vtkIdList> from;
    for (const vtkIdType point : points) {
        places->InsertNextPoint(data.GetPoint(point));
        from->InsertNextId(point);
    }
    surface->SetPoints(places);
    copy_tuples(*data.GetPointData(), *from, *surface->GetPointData());
    // A surface counts its points first, then its lines, then its faces.
    std::stable_sort(cells.begin(), cells.end(), [&](vtkIdType a, vtkIdType b) {
        return list_of(data.GetCellType(a)) < list_of(data.GetCellType(b));
    });
    std::array<vtkSmartPointer<vtkCellArray>, 3> lists;
    for (auto& list : lists) {
        list = vtkSmartPointer<vtkCellArray>::New();
    }
    vtkNew<vtkIdList> nodes;
    from->Reset();
    for (const vtkIdType cell : cells) {
        data.GetCellPoints(cell, nodes);
        for (vtkIdType k = 0; k < nodes->GetNumberOfIds(); ++k) {
            nodes->SetId(k, std::lower_bound(points.begin(), points.end(), nodes->GetId(k)) - points.begin());
        }
        lists.at(static_cast<std::size_t>(list_of(data.GetCellType(cell))))->InsertNextCell(nodes);
        from->InsertNextId(cell);
    }
    surface->SetVerts(lists[0]);
    surface->SetLines(lists[1]);
    surface->SetPolys(lists[2]);
    copy_tuples(*data.GetCellData(), *from, *surface->GetCellData());
    return surface;
}

vtkSmartPointer<vtkDataSet> grid_from(vtkDataSet& data, const std::vector<vtkIdType>& cells) {
    vtkNew<vtkIdList> list;
    for (const vtkIdType cell : cells) {
        list->InsertNextId(cell);
    }
    vtkNew<vtkExtractCells> extract;
    extract->SetInputData(&data);
    extract->SetCellList(list);
    extract->Update();
    vtkSmartPointer<vtkDataSet> grid = extract->GetOutput();
    grid->GetCellData()->RemoveArray("vtkOriginalCellIds");
    return grid;
}

/// The cells of each mark; all under the mark of the only zone when there is just one. Empty: nothing tells them apart.
std::map<int, std::vector<vtkIdType>> cells_by_mark(vtkDataSet& data, const Description& description) {
    vtkDataArray* marks = data.GetCellData()->GetArray(mark_name);
    const bool single = description.zones.size() == 1;
    std::map<int, std::vector<vtkIdType>> cells;
    if (!single && (marks == nullptr || marks->GetNumberOfComponents() != 1)) {
        return cells;
    }
    for (vtkIdType c = 0; c < data.GetNumberOfCells(); ++c) {
        cells[single ? description.zones[0].mark : static_cast<int>(marks->GetComponent(c, 0))].push_back(c);
    }
    for (const auto& zone : description.zones) {
        cells.try_emplace(zone.mark);  // of points without cells
    }
    return cells;
}

}  // namespace

std::vector<ZonePart> parts_of(vtkDataSet& data, const Description& description) {
    for (const char* name : {description_name, "origin", "units", "zone_names"}) {
        data.GetFieldData()->RemoveArray(name);
    }
    auto cells = cells_by_mark(data, description);
    const auto& own = description.zones[0].zone.arrays;
    const bool another =
        description.zones.size() == 1 &&
        std::any_of(own.begin(), own.end(), [](const ArrayInfo& info) { return info.name == mark_name; });
    if (!cells.empty() && !another) {
        data.GetCellData()->RemoveArray(mark_name);
    }
    long long points = 0;
    bool whole = true;
    for (const auto& zone : description.zones) {
        points += zone.points;
        whole = whole && (cells.empty() || static_cast<long long>(cells[zone.mark].size()) == zone.cells);
    }
    whole = whole && points == data.GetNumberOfPoints();
    std::vector<ZonePart> parts;
    const auto add = [&](const DescribedZone& described, const std::vector<vtkIdType>& own_cells, vtkIdType first) {
        ZonePart part{described.zone, nullptr, whole};
        const bool flat = std::all_of(own_cells.begin(), own_cells.end(),
                                      [&](vtkIdType c) { return list_of(data.GetCellType(c)) < 3; });
        const bool surface = vtkPolyData::SafeDownCast(&data) != nullptr || (described.surface && flat);
        if (description.zones.size() == 1 && surface == (vtkPolyData::SafeDownCast(&data) != nullptr)) {
            part.data = &data;
        } else if (surface) {
            part.data = surface_from(data, own_cells, first, whole ? described.points : 0);
        } else if (!own_cells.empty()) {
            part.data = grid_from(data, own_cells);
        }
        if (surface != described.surface) {
            part.zone.kind = surface ? ZoneKind::unknown : ZoneKind::fluid;  // a section, or something made thick
        }
        if (part.data != nullptr && part.data->GetNumberOfPoints() > 0) {
            parts.push_back(std::move(part));
        }
    };
    vtkIdType first = 0;
    for (const auto& zone : description.zones) {
        if (!cells.empty()) {
            add(zone, cells[zone.mark], first);
            cells.erase(zone.mark);
        }
        first += zone.points;
    }
    for (const auto& [mark, others] : cells) {
        DescribedZone unknown;
        unknown.zone.name = "zone " + std::to_string(mark);
        unknown.zone.id = mark;
        unknown.surface = vtkPolyData::SafeDownCast(&data) != nullptr;
        add(unknown, others, 0);
    }
    return parts;
}

}  // namespace underbody::postproc
