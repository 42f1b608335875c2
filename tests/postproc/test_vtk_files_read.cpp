// VTK's own files and surfaces, whole and damaged: what other programs write.
#include <gmock/gmock.h>
#include <vtkCellData.h>
#include <vtkCleanPolyData.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkStringArray.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLPolyDataWriter.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>

#include "core/file.h"
#include "import_support.h"
#include "postproc/field/vtk_files.h"
#include "postproc/loads/loads.h"
#include "tests/support/support.h"

namespace underbody {

using postproc::read_field;
using ::testing::HasSubstr;

namespace {

namespace fs = std::filesystem;

fs::path written(const core::TemporaryFolder& folder, const std::string& name, const std::string& text) {
    std::ofstream(folder.path() / name, std::ios::binary) << text;
    return folder.path() / name;
}

const std::string tetrahedron =
    "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\"><UnstructuredGrid>\n"
    "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><PointData><DataArray type=\"Float64\" Name=\"Pressure\" "
    "format=\"ascii\">1 2 3 4</DataArray></PointData>\n"
    "<CellData><DataArray type=\"Float32\" Name=\"U\" NumberOfComponents=\"3\" format=\"ascii\">5 6 "
    "7</DataArray></CellData>\n"
    "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 "
    "1</DataArray></Points>\n"
    "<Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 2 3</DataArray>"
    "<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">4</DataArray>"
    "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">10</DataArray></Cells>\n"
    "</Piece></UnstructuredGrid></VTKFile>\n";

const std::string ply =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 "
    "3\n";

const std::string legacy =
    "# vtk DataFile Version 3.0\ntest\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 1\n"
    "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\nPOINT_DATA 4\nSCALARS pressure double 1\nLOOKUP_TABLE default\n1 2 3 4\n";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

/// A damaged file is refused, or what matters of it was whole.
void expect_safe(const fs::path& path) {
    try {
        const auto field = read_field(path);
        const auto& zone = field.zones.at(0);
        if (zone.surface != nullptr) {
            EXPECT_NEAR(test::area_of(*zone.surface), 1, 1e-6) << path;
        } else {
            EXPECT_NEAR(test::volume_of(*zone.volume), 1.0 / 6, 1e-12) << path;
        }
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr(path.filename().string()));
    }
}

/// The faces of a tetrahedron as a grid, with a pressure of 1 + 2x + 3y + 4z at its corners.
const std::string hull =
    "# vtk DataFile Version 3.0\ntest\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 1\n"
    "CELLS 4 16\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\nCELL_TYPES 4\n5 5 5 5\nPOINT_DATA 4\nSCALARS pressure double "
    "1\nLOOKUP_TABLE default\n"
    "1 3 4 5\n";

}  // namespace

TEST(VtkFiles, GridsOfFacesAreSurfacesUnlessTheyArePlane) {
    const core::TemporaryFolder folder;
    const auto field = read_field(written(folder, "hull.vtk", hull));
    ASSERT_NE(field.zones.at(0).surface, nullptr);
    EXPECT_EQ(field.zones[0].volume, nullptr);
    const auto loads = postproc::loads(field);
    EXPECT_EQ(loads.values_from, "nodes");
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(loads.total.force[k], -(2.0 + static_cast<double>(k)) / 6, 1e-12);  // minus gradient times volume
    }
    const auto plane = read_field(written(folder, "plane.vtk", replaced(hull, "0 0 0 1\nCELLS", "0 1 1 0\nCELLS")));
    EXPECT_NE(plane.zones.at(0).volume, nullptr);
}

TEST(VtkFiles, XmlLegacyAndStructuredGridsHaveTheirCellsAndArrays) {
    const core::TemporaryFolder folder;
    const auto xml = read_field(written(folder, "a.vtu", tetrahedron));
    EXPECT_NEAR(test::volume_of(xml), 1.0 / 6, 1e-15);
    EXPECT_NE(xml.zones.at(0).find("pressure"), nullptr);
    EXPECT_NE(xml.zones.at(0).find("velocity"), nullptr);
    const auto old = read_field(written(folder, "a.vtk", legacy));
    EXPECT_NEAR(test::volume_of(old), 1.0 / 6, 1e-15);
    const auto grid =
        read_field(written(folder, "b.vtk",
                           "# vtk DataFile Version 3.0\ntest\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 3 2 2\n"
                           "X_COORDINATES 3 double\n0 1 3\nY_COORDINATES 2 double\n0 1\nZ_COORDINATES 2 double\n0 2\n"
                           "CELL_DATA 2\nSCALARS pressure double 1\nLOOKUP_TABLE default\n1 2\n"));
    EXPECT_EQ(test::cells_of(grid), 2);
    EXPECT_NEAR(test::volume_of(grid), 6, 1e-12);
    EXPECT_EQ(grid.zones.at(0).volume->GetCellData()->GetArray("pressure")->GetTuple1(1), 2);
}

/// Everything of a field but its files, format and notes.
void expect_same(const postproc::Field& found, const postproc::Field& wanted, bool volumes) {
    EXPECT_EQ(found.dimension, wanted.dimension);
    EXPECT_EQ(found.writer, wanted.writer);
    EXPECT_EQ(found.pressure.kind, wanted.pressure.kind);
    EXPECT_EQ(found.pressure.operating_pressure, wanted.pressure.operating_pressure);
    EXPECT_EQ(found.density, wanted.density);
    std::size_t count = 0;
    for (const auto& zone : wanted.zones) {
        if (zone.surface == nullptr && !volumes) {
            continue;
        }
        SCOPED_TRACE(zone.name);
        ++count;
        const auto* again = found.find(zone.name);
        ASSERT_NE(again, nullptr);
        EXPECT_EQ(again->id, zone.id);
        EXPECT_EQ(again->kind, zone.kind);
        EXPECT_EQ(again->original_kind, zone.original_kind);
        EXPECT_EQ(again->normals_into_fluid, zone.normals_into_fluid);
        ASSERT_EQ(again->surface != nullptr, zone.surface != nullptr);
        vtkPointSet* before = zone.surface != nullptr ? static_cast<vtkPointSet*>(zone.surface) : zone.volume;
        vtkPointSet* after = again->surface != nullptr ? static_cast<vtkPointSet*>(again->surface) : again->volume;
        EXPECT_EQ(after->GetNumberOfPoints(), before->GetNumberOfPoints());
        EXPECT_EQ(after->GetNumberOfCells(), before->GetNumberOfCells());
        EXPECT_EQ(again->arrays.size(), zone.arrays.size());
        for (const auto& info : zone.arrays) {
            const auto* array = again->find(info.name);
            ASSERT_NE(array, nullptr) << info.name;
            EXPECT_EQ(array->unit, info.unit);
            EXPECT_EQ(array->original_name, info.original_name);
            EXPECT_EQ(array->on, zone.find(info.name)->on);  // several places may have one name: the first
        }
    }
    EXPECT_EQ(found.zones.size(), count);
}

TEST(VtkFiles, WhatImportWritesGivesTheSameLoadsOfTheSameBody) {
    const core::TemporaryFolder folder;
    // A body over a ground, whose zones have no kinds and not the same arrays.
    core::write_file(folder.path() / "body.csv",
                     "[Name]\nhull\n[Data]\nX [ m ], Y [ m ], Z [ m ], Pressure [ Pa ], "
                     "Yplus\n0,0,1,1,5\n1,0,1,3,5\n0,1,1,4,5\n0,0,2,5,5\n[Faces]\n0,1,3\n1,2,3\n0,3,2\n\n"
                     "[Name]\nbase\n[Data]\nX [ m ], Y [ m ], Z [ m ], Pressure [ Pa "
                     "]\n0,0,1,1\n1,0,1,3\n0,1,1,4\n[Faces]\n0,2,1\n\n"
                     "[Name]\nground\n[Data]\nX [ m ], Y [ m ], Z [ m ], Pressure [ Pa "
                     "]\n-9,-9,0,1\n9,-9,0,1\n9,9,0,1\n-9,9,0,1\n[Faces]\n0,1,2,3\n");
    const std::vector<std::pair<fs::path, std::vector<std::string>>> cases = {
        {folder.path() / "body.csv", {}},
        {test::data_folder() / "fluent_legacy/ascii.dat", {"body"}},
        {test::data_folder() / "openfoam/ascii", {"*Wall*"}},
        {test::data_folder() / "cgns/cfx-like.cgns", {}},
        {test::data_folder() / "cgns/polyhedra.cgns", {}}};
    for (const auto& [file, zones] : cases) {
        const auto field = read_field(file);
        for (const char* ending : {".vtm", ".vtp", ".vtu"}) {
            if (ending == std::string(".vtu") && file.extension() != ".csv") {
                continue;  // takes the volumes only
            }
            SCOPED_TRACE(file.string() + " as " + ending);
            const fs::path out = folder.path() / ("out" + std::string(ending));
            postproc::write_vtk(field, out);
            const auto again = read_field(out);
            expect_same(again, field, ending == std::string(".vtm"));
            postproc::LoadsOptions options;
            options.zones = zones;
            const auto wanted = postproc::loads(field, options);
            const auto found = postproc::loads(again, options);
            EXPECT_EQ(found.values_from, wanted.values_from);
            ASSERT_EQ(found.zones.size(), wanted.zones.size());
            for (std::size_t z = 0; z < found.zones.size(); ++z) {
                EXPECT_EQ(found.zones[z].name, wanted.zones[z].name);
            }
            for (std::size_t k = 0; k < 3; ++k) {
                EXPECT_NEAR(found.pressure.force[k], wanted.pressure.force[k], 1e-12 * wanted.area);
                EXPECT_NEAR(found.viscous.force[k], wanted.viscous.force[k], 1e-12 * wanted.area);
                EXPECT_NEAR(found.total.moment[k], wanted.total.moment[k], 1e-12 * wanted.area);
            }
        }
    }
}

TEST(VtkFiles, FilesOfOursThatOthersChangedKeepWhatIsStillTrue) {
    const core::TemporaryFolder folder;
    const auto field = read_field(test::data_folder() / "fluent_legacy" / "ascii.dat");
    postproc::write_vtk(field, folder.path() / "all.vtp");
    const auto changed = [&](const std::function<void(vtkPolyData&)>& change) {
        vtkNew<vtkXMLPolyDataReader> reader;
        reader->SetFileName((folder.path() / "all.vtp").c_str());
        reader->Update();
        change(*reader->GetOutput());
        vtkNew<vtkXMLPolyDataWriter> writer;
        writer->SetFileName((folder.path() / "changed.vtp").c_str());
        writer->SetInputData(reader->GetOutput());
        writer->Write();
        return read_field(folder.path() / "changed.vtp");
    };
    // Points that lay on each other became one: which side the faces look to may have changed too.
    const auto merged = changed([](vtkPolyData& data) {
        vtkNew<vtkCleanPolyData> clean;
        clean->SetInputData(&data);
        clean->Update();
        data.ShallowCopy(clean->GetOutput());
    });
    ASSERT_EQ(merged.zones.size(),
              static_cast<std::size_t>(std::count_if(field.zones.begin(), field.zones.end(),
                                                     [](const auto& zone) { return zone.surface != nullptr; })));
    for (const auto& zone : merged.zones) {
        const auto* before = field.find(zone.name);
        ASSERT_NE(before, nullptr) << zone.name;
        EXPECT_EQ(zone.kind, before->kind);
        EXPECT_FALSE(zone.normals_into_fluid);
        EXPECT_NEAR(test::area_of(*zone.surface), test::area_of(*before->surface), 1e-12);
    }
    // Nothing tells the zones apart any more.
    const auto unmarked = changed([](vtkPolyData& data) { data.GetCellData()->RemoveArray("zone"); });
    EXPECT_EQ(unmarked.zones.size(), 1U);
    EXPECT_THAT(test::told(unmarked), HasSubstr("its cells no longer say which they are of"));
    // Marks that nobody knows, descriptions that are none: no harm.
    const auto others =
        changed([](vtkPolyData& data) { data.GetCellData()->GetArray("zone")->SetComponent(0, 0, 4711); });
    EXPECT_NE(others.find("zone 4711"), nullptr);
    for (const char* text : {"", "{", "[]", "{\"version\": 1}", "{\"version\": 1, \"zones\": 3}"}) {
        const auto damaged = changed([&](vtkPolyData& data) {
            vtkStringArray::SafeDownCast(data.GetFieldData()->GetAbstractArray("underbody"))->SetValue(0, text);
        });
        EXPECT_EQ(damaged.zones.size(), 1U) << text;
    }
}

TEST(VtkFiles, WhatAFileLeavesOutIsTold) {
    const core::TemporaryFolder folder;
    const auto field = read_field(test::data_folder() / "fluent_legacy" / "ascii.dat");
    const auto told = [&](const std::string& name) {
        std::string text;
        for (const auto& problem : postproc::write_vtk(field, folder.path() / name)) {
            text += problem.message + "\n";
        }
        return text;
    };
    EXPECT_THAT(told("a.vtu"), HasSubstr("left out: '"));
    EXPECT_THAT(told("a.vtp"), HasSubstr("left out: '"));
    EXPECT_THAT(told("a.vtm"), testing::Not(HasSubstr("left out")));
}

TEST(VtkFiles, WhatImportWritesIsReadAgainTheSame) {
    const core::TemporaryFolder folder;
    const auto whole = read_field(test::data_folder() / "fluent_legacy" / "ascii.cas");
    postproc::write_vtk(whole, folder.path() / "all.vtm");
    const auto again = read_field(folder.path() / "all.vtm");
    EXPECT_NEAR(test::volume_of(again), test::volume_of(whole), 1e-12);
    postproc::write_vtk(whole, folder.path() / "all.vtp");
    const auto surfaces = read_field(folder.path() / "all.vtp");
    ASSERT_FALSE(surfaces.zones.empty());
    EXPECT_NE(surfaces.zones[0].find("pressure"), nullptr);
    postproc::write_vtk(whole, folder.path() / "all.vtu");
    EXPECT_NEAR(test::volume_of(read_field(folder.path() / "all.vtu")), test::volume_of(whole), 1e-12);
}

TEST(VtkFiles, TheCellsOfAVolumeTellOnWhichSideOfItsWallsTheFluidIs) {
    const core::TemporaryFolder folder;
    auto whole = read_field(test::data_folder() / "fluent_legacy" / "ascii.cas");
    for (auto& zone : whole.zones) {
        if (zone.surface != nullptr) {
            zone.normals_into_fluid = false;
            zone.surface->BuildCells();
            for (vtkIdType face = 1; face < zone.surface->GetNumberOfCells(); face += 2) {
                zone.surface->ReverseCell(face);  // a writer that cares for no order
            }
        }
    }
    postproc::write_vtk(whole, folder.path() / "all.vtm");
    const auto right = read_field(test::data_folder() / "fluent_legacy" / "ascii.cas");
    int walls = 0;
    for (const bool surfaces_only : {false, true}) {
        postproc::ReadOptions options;
        options.surfaces_only = surfaces_only;
        const auto field = read_field(folder.path() / "all.vtm", options);
        for (const auto& zone : field.zones) {
            EXPECT_FALSE(surfaces_only && zone.volume != nullptr) << zone.name;
            if (zone.surface == nullptr) {
                continue;
            }
            EXPECT_TRUE(zone.normals_into_fluid) << zone.name;
            const auto* same = right.find(zone.name);
            ASSERT_NE(same, nullptr) << zone.name;
            for (std::size_t k = 0; k < 3; ++k) {
                EXPECT_NEAR(test::pressure_force(*zone.surface)[k], test::pressure_force(*same->surface)[k], 1e-12)
                    << zone.name;
            }
            ++walls;
        }
    }
    EXPECT_GT(walls, 2);
}

TEST(VtkFiles, GhostCellsOfAnotherProcessAreLeftOutAndStripsAreTriangles) {
    const core::TemporaryFolder folder;
    const auto surface = [](const std::string& cells, const std::string& data) {
        return "<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\"><PolyData>\n"
               "<Piece NumberOfPoints=\"4\" " +
               cells.substr(0, cells.find('|')) +
               ">\n<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">"
               "0 0 0 1 0 0 0 1 0 1 1 0</DataArray></Points>\n" +
               cells.substr(cells.find('|') + 1) + "<CellData>" + data + "</CellData></Piece></PolyData></VTKFile>\n";
    };
    const auto array = [](const char* type, const char* name, const char* values) {
        return std::string("<DataArray type=\"") + type + "\" Name=\"" + name + "\" format=\"ascii\">" + values +
               "</DataArray>";
    };
    const auto ghosts =
        read_field(written(folder, "ghosts.vtp",
                           surface("NumberOfPolys=\"2\"|<Polys>" + array("Int64", "connectivity", "0 1 2 1 3 2") +
                                       array("Int64", "offsets", "3 6") + "</Polys>",
                                   array("UInt8", "vtkGhostType", "0 1") + array("Float64", "pressure", "5 7"))));
    EXPECT_NEAR(test::area_of(*ghosts.zones.at(0).surface), 0.5, 1e-12);
    EXPECT_EQ(test::range_of(*ghosts.zones[0].surface, "pressure").high, 5);
    EXPECT_EQ(ghosts.zones[0].arrays.size(), 1U);
    const auto strip =
        read_field(written(folder, "strip.vtp",
                           surface("NumberOfStrips=\"1\"|<Strips>" + array("Int64", "connectivity", "0 1 2 3") +
                                       array("Int64", "offsets", "4") + "</Strips>",
                                   array("Float64", "pressure", "5"))));
    EXPECT_EQ(strip.zones.at(0).surface->GetNumberOfPolys(), 2);
    EXPECT_NEAR(test::area_of(*strip.zones[0].surface), 1, 1e-12);
    EXPECT_EQ(strip.zones[0].surface->GetCellData()->GetArray("pressure")->GetTuple1(1), 5);
}

TEST(VtkFiles, SurfacesInPlyObjAndBothKindsOfStlHaveTheirArea) {
    const core::TemporaryFolder folder;
    EXPECT_NEAR(test::area_of(*read_field(written(folder, "a.ply", ply)).zones.at(0).surface), 1, 1e-6);
    EXPECT_NEAR(test::area_of(
                    *read_field(written(folder, "a.obj", "# a square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"))
                         .zones.at(0)
                         .surface),
                1, 1e-6);
    std::string stl(84 + 50, '\0');
    const std::uint32_t one = 1;
    const float corners[12] = {0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
    std::memcpy(stl.data() + 80, &one, 4);
    std::memcpy(stl.data() + 84, corners, sizeof corners);
    EXPECT_NEAR(test::area_of(*read_field(written(folder, "a.stl", stl)).zones.at(0).surface), 0.5, 1e-6);
    EXPECT_NE(test::refusal(written(folder, "b.stl", stl.substr(0, 120))), "");
}

TEST(VtkFiles, PAndWallShearStressOfOpenFoamWaitForTheirUnit) {
    const core::TemporaryFolder folder;
    const auto path = written(folder, "a.vtk",
                              "# vtk DataFile Version 3.0\ntest\nASCII\nDATASET POLYDATA\nPOINTS 3 double\n0 0 0 1 0 0 "
                              "0 1 0\nPOLYGONS 1 4\n3 0 1 2\n"
                              "CELL_DATA 1\nFIELD attributes 2\np 1 1 double\n7\nwallShearStress 3 1 double\n1 2 3\n");
    const auto plain = read_field(path);
    EXPECT_EQ(plain.zones.at(0).find("pressure"), nullptr);
    EXPECT_EQ(plain.zones.at(0).find("wall_shear"), nullptr);
    EXPECT_NE(plain.zones.at(0).find("p (unit not stated)"), nullptr);
    EXPECT_THAT(plain.problems.front().message, HasSubstr("option 'unit p=m^2/s^2'"));
    const auto value = [&](const char* unit, const char* array, int component) {
        postproc::ReadOptions options;
        options.units = {{"p", unit}};
        const auto field = read_field(path, options);
        auto* data = field.zones.at(0).surface->GetCellData()->GetArray(array);
        return data != nullptr ? data->GetComponent(0, component) : std::nan("");
    };
    EXPECT_EQ(value("Pa", "pressure", 0), 7);
    EXPECT_EQ(value("m^2/s^2", "kinematic_pressure", 0), 7);
    // The traction that OpenFOAM states acts on the fluid.
    EXPECT_EQ(value("Pa", "wall_shear", 2), -3);
    EXPECT_EQ(value("m^2/s^2", "kinematic_wall_shear", 1), -2);
}

TEST(TecplotFiles, WithUnitsRepeatCountsOrSharedVariablesAreRefusedInWords) {
    const core::TemporaryFolder folder;
    const auto file = [&](const std::string& variables, const std::string& zone, const std::string& last) {
        return written(folder, "a.dat",
                       "TITLE = \"a\"\nVARIABLES = " + variables +
                           "\nZONE T=\"hull\" N=4, E=2, F=FEPOINT, ET=TRIANGLE" + zone +
                           "\n0 0 0 7\n1 0 0 8\n0 1 0 9\n0 0 1 6\n1 2 3\n" + last);
    };
    const auto plain = read_field(file("\"X\" \"Y\" \"Z\" \"Pressure [ kPa ]\"", "", "1 2 4\n"));
    EXPECT_NEAR(test::area_of(*plain.zones.at(0).surface), 1, 1e-12);
    ASSERT_NE(plain.zones[0].find("pressure"), nullptr);
    EXPECT_EQ(plain.zones[0].find("pressure")->original_unit, "kPa");
    EXPECT_NEAR(plain.zones[0].surface->GetPointData()->GetArray("pressure")->GetTuple1(2), 9000, 1e-9);
    EXPECT_THAT(test::refusal(file("\"X [ m ]\" \"Y [ m ]\" \"Z [ m ]\" \"Pressure\"", "", "1 2 4\n")),
                HasSubstr("'X [ m ]' is a coordinate"));
    EXPECT_THAT(test::refusal(file("\"X\" \"Y\" \"Z\" \"P\"", "", "3*1\n")), HasSubstr("repeat counts"));
    EXPECT_THAT(test::refusal(file("\"X\" \"Y\" \"Z\" \"P\"", "", "3*1\n")), HasSubstr("a.dat:9"));
    EXPECT_THAT(test::refusal(file("\"X\" \"Y\" \"Z\" \"P\"", ", varsharelist=([1-3]=1)", "1 2 4\n")),
                HasSubstr("VARSHARELIST"));
}

TEST(VtkFiles, BracketsBehindANameAreAUnitOrAnIndex) {
    const core::TemporaryFolder folder;
    const auto field = read_field(written(folder, "a.vtk",
                                          "# vtk DataFile Version 3.0\ntest\nASCII\nDATASET POLYDATA\nPOINTS 3 "
                                          "double\n0 0 0 1 0 0 0 1 0\nPOLYGONS 1 4\n3 0 1 2\n"
                                          "CELL_DATA 1\nFIELD attributes 3\nspecies[2] 1 1 double\n7\nPressure[kPa] 1 "
                                          "1 double\n3\nspecies[3] 1 1 double\n8\n"));
    const auto value = [&](const char* name) {
        auto* data = field.zones.at(0).surface->GetCellData()->GetArray(name);
        return data != nullptr ? data->GetComponent(0, 0) : std::nan("");
    };
    EXPECT_EQ(value("species[2]"), 7);
    EXPECT_EQ(value("species[3]"), 8);
    EXPECT_EQ(value("pressure"), 3000);
}

TEST(VtkFiles, NumbersOnThePointsAndFacesOfAPlyAreArrays) {
    const core::TemporaryFolder folder;
    const auto field = read_field(written(folder, "a.ply",
                                          "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float "
                                          "y\nproperty float z\nproperty float Pressure\n"
                                          "element face 1\nproperty list uchar int vertex_index\nproperty float "
                                          "quality\nend_header\n0 0 0 7\n2 0 0 8\n0 2 0 9\n3 0 1 2 0.5\n"));
    const auto& zone = field.zones.at(0);
    EXPECT_NEAR(test::area_of(*zone.surface), 2, 1e-12);
    ASSERT_NE(zone.find("pressure"), nullptr);
    EXPECT_EQ(zone.find("pressure")->on, postproc::Location::nodes);
    EXPECT_EQ(zone.surface->GetPointData()->GetArray("pressure")->GetComponent(2, 0), 9);
    ASSERT_NE(zone.find("quality"), nullptr);
    EXPECT_EQ(zone.find("quality")->on, postproc::Location::faces);
}

TEST(VtkFiles, WrongIndicesCountsAndOffsetsAreRefused) {
    const core::TemporaryFolder folder;
    const auto xml = [&](const std::string& what, const std::string& by) {
        return test::refusal(written(folder, "wrong.vtu", replaced(tetrahedron, what, by)));
    };
    EXPECT_THAT(xml("0 1 2 3</DataArray>", "0 1 2 99</DataArray>"), HasSubstr("names point 99 of 4"));
    EXPECT_THAT(xml("0 1 2 3</DataArray>", "0 1 2 -3</DataArray>"), HasSubstr("names point -3 of 4"));
    // What VTK says goes into the error, not to the terminal.
    testing::internal::CaptureStderr();
    EXPECT_THAT(xml("</Cells>", ""), HasSubstr("XML"));
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_NE(xml("NumberOfPoints=\"4\"", "NumberOfPoints=\"400000000000\""), "");
    EXPECT_NE(xml("NumberOfCells=\"1\"", "NumberOfCells=\"1000000000\""), "");
    EXPECT_NE(xml("format=\"ascii\">4</DataArray>", "format=\"ascii\">4000</DataArray>"), "");
    const auto old = [&](const std::string& what, const std::string& by) {
        return test::refusal(written(folder, "wrong.vtk", replaced(legacy, what, by)));
    };
    EXPECT_THAT(old("4 0 1 2 3", "4 0 1 2 77"), HasSubstr("names point 77 of 4"));
    EXPECT_NE(old("POINTS 4 double", "POINTS 400000000000 double"), "");
    EXPECT_THAT(test::refusal(written(folder, "wrong.ply", replaced(ply, "3 0 2 3\n", "3 0 2 300\n"))),
                HasSubstr("names vertex 300"));
    EXPECT_NE(
        test::refusal(written(folder, "wrong2.ply", replaced(ply, "element vertex 4", "element vertex 400000000"))),
        "");
    EXPECT_NE(test::refusal(written(folder, "wrong.obj", "v 0 0 0\nv 1 0 0\nf 1 2 30\n")), "");
}

TEST(VtkFiles, FilesCutAnywhereAreReadOrRefused) {
    const core::TemporaryFolder folder;
    for (const auto& [name, text] :
         {std::pair<std::string, std::string>{"cut.vtu", tetrahedron}, {"cut.vtk", legacy}, {"cut.ply", ply}}) {
        for (std::size_t size = 1; size < text.size(); size += text.size() / 60 + 1) {
            expect_safe(written(folder, name, text.substr(0, size)));
        }
    }
}

}  // namespace underbody
