// Loads against closed forms.
#include <gmock/gmock.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "core/parallel.h"
#include "core/random.h"
#include "postproc/loads/loads.h"
#include "postproc/loads/loads_table.h"
#include "postproc/loads/mesh_study.h"

namespace underbody::postproc {
namespace {

using testing::HasSubstr;
using PointFunction = std::function<double(const Vector&)>;

/// A zone from points and faces, with pressure and shear as functions of the place, on nodes.
Zone make_zone(const std::string& name, const std::vector<Vector>& points,
               const std::vector<std::vector<vtkIdType>>& faces, const PointFunction& pressure,
               const std::function<Vector(const Vector&)>& shear = {}) {
    Zone zone;
    zone.name = name;
    zone.kind = ZoneKind::wall;
    zone.normals_into_fluid = false;
    zone.surface = vtkSmartPointer<vtkPolyData>::New();
    vtkNew<vtkPoints> places;
    places->SetDataTypeToDouble();
    vtkNew<vtkDoubleArray> values;
    values->SetName("pressure");
    vtkNew<vtkDoubleArray> tractions;
    tractions->SetName("wall_shear");
    tractions->SetNumberOfComponents(3);
    for (const auto& p : points) {
        places->InsertNextPoint(p.data());
        values->InsertNextValue(pressure(p));
        const Vector t = shear ? shear(p) : Vector{};
        tractions->InsertNextTuple(t.data());
    }
    vtkNew<vtkCellArray> cells;
    for (const auto& face : faces) {
        cells->InsertNextCell(static_cast<vtkIdType>(face.size()), face.data());
    }
    zone.surface->SetPoints(places);
    zone.surface->SetPolys(cells);
    zone.surface->GetPointData()->AddArray(values);
    zone.surface->GetPointData()->AddArray(tractions);
    zone.arrays = {{"pressure", "Pa", "Pressure", "Pa", Location::nodes, 1},
                   {"wall_shear", "Pa", "Wall Shear X", "Pa", Location::nodes, 3}};
    return zone;
}

/// An ellipsoid of quads (triangles at the poles), optionally cut at y = 0 to a half model; `turned`: normals inward.
Zone ellipsoid(int rings, const Vector& axes, const PointFunction& pressure, bool half = false, bool turned = false,
               const std::string& name = "hull", const std::function<Vector(const Vector&)>& shear = {}) {
    std::vector<Vector> points;
    std::vector<std::vector<vtkIdType>> faces;
    const int around = half ? rings : 2 * rings;
    const int columns = half ? around + 1 : around;
    for (int i = 0; i <= rings; ++i) {
        for (int j = 0; j < columns; ++j) {
            const double theta = M_PI * i / rings;
            const double phi = (half ? M_PI : 2 * M_PI) * j / around;
            double y = axes[1] * std::sin(theta) * std::sin(phi);
            if (half && (j == 0 || j == around)) {
                y = 0;
            }
            points.push_back({axes[0] * std::sin(theta) * std::cos(phi), y, axes[2] * std::cos(theta)});
        }
    }
    for (int i = 0; i < rings; ++i) {
        for (int j = 0; j < around; ++j) {
            const vtkIdType a = i * columns + j;
            const vtkIdType b = i * columns + (j + 1) % columns;
            const vtkIdType c = b + columns;
            const vtkIdType d = a + columns;
            std::vector<vtkIdType> face = i == 0           ? std::vector<vtkIdType>{a, d, c}
                                          : i == rings - 1 ? std::vector<vtkIdType>{a, d, b}
                                                           : std::vector<vtkIdType>{a, d, c, b};
            if (turned) {
                std::reverse(face.begin(), face.end());
            }
            faces.push_back(face);
        }
    }
    return make_zone(name, points, faces, pressure, shear);
}

Field field_of(std::vector<Zone> zones) {
    Field field;
    field.files = {"made.csv"};
    field.zones = std::move(zones);
    return field;
}

LoadsOptions about(const Vector& reference, const std::string& symmetry = "") {
    LoadsOptions options;
    options.reference = reference;
    options.symmetry = symmetry;
    return options;
}

constexpr double g = 9.80665;
constexpr double rho = 998;
double hydrostatic(const Vector& p) { return -rho * g * p[2] + 5000; }

TEST(Loads, OfHydrostaticPressureAreTheBuoyancyAtTheCentroid) {
    const Vector axes = {0.1, 0.07, 0.05};
    for (const bool turned : {false, true}) {
        const auto result = loads(field_of({ellipsoid(60, axes, hydrostatic, false, turned)}), about({0.3, -0.2, 0.1}));
        const double buoyancy = rho * g * 4 * M_PI / 3 * axes[0] * axes[1] * axes[2];
        EXPECT_NEAR(result.named.lift_force, buoyancy, 2.2e-3 * buoyancy);  // the polyhedron has less volume
        EXPECT_NEAR(result.named.drag_force, 0, 1e-9 * buoyancy);
        // The buoyancy acts at the centroid (0, 0, 0): moment = (0 - reference) x F.
        EXPECT_NEAR(result.total.moment[0], 0.2 * result.total.force[2], 1e-9);
        EXPECT_NEAR(result.total.moment[1], 0.3 * result.total.force[2], 1e-9);
        EXPECT_LT(result.closure, 1e-12);
        EXPECT_THAT(result.orientation, HasSubstr("closes"));
        EXPECT_EQ(result.zones[0].turned, turned);
        ASSERT_TRUE(result.centre_of_pressure);
        EXPECT_NEAR((*result.centre_of_pressure)[0], 0, 1e-9);
    }
}

TEST(Loads, ConvergeToTheBuoyancyWithTheSecondOrder) {
    const double exact = rho * g * 4 * M_PI / 3 * 1e-3;
    double last = 0;
    for (const int rings : {20, 40, 80}) {
        const double error =
            exact - loads(field_of({ellipsoid(rings, {0.1, 0.1, 0.1}, hydrostatic)}), about({})).named.lift_force;
        if (last > 0) {
            EXPECT_NEAR(last / error, 4, 0.1);
        }
        last = error;
    }
}

TEST(Loads, ShearOnAWarpedPolygonActsOnTheSizeOfItsAreaVector) {
    // A pyramid whose base is a warped hexagon; a finite-volume solver's face force is the traction times that size,
    // and a Fluent file states forces, made tractions by it: the sum has to give them back.
    std::vector<Vector> points;
    for (int i = 0; i < 6; ++i) {
        points.push_back({std::cos(M_PI * i / 3), std::sin(M_PI * i / 3), i % 2 == 0 ? 0.1 : -0.1});
    }
    points.push_back({0, 0, 2});
    std::vector<std::vector<vtkIdType>> faces = {{5, 4, 3, 2, 1, 0}};
    Vector area{};
    for (int i = 0; i < 6; ++i) {
        faces.push_back({i, (i + 1) % 6, 6});
        const Vector part = cross(points[static_cast<std::size_t>(i)], points[static_cast<std::size_t>((i + 1) % 6)]);
        area = plus(area, part, 0.5);
    }
    Zone zone = make_zone("base", points, faces, [](const Vector&) { return 0; });
    vtkNew<vtkDoubleArray> shear;
    shear->SetName("wall_shear");
    shear->SetNumberOfComponents(3);
    for (std::size_t f = 0; f < faces.size(); ++f) {
        shear->InsertNextTuple3(f == 0 ? 3 : 0, 0, 0);
    }
    zone.surface->GetPointData()->RemoveArray("wall_shear");
    zone.surface->GetCellData()->AddArray(shear);
    zone.arrays[1].on = Location::faces;
    const auto result = loads(field_of({zone}), about({}));
    EXPECT_NEAR(result.viscous.force[0], 3 * norm(area), 1e-12);
    EXPECT_NEAR(norm(area), 3 * std::sqrt(3.0) / 2, 1e-12);  // the warp cancels in it: that of the flat hexagon
    // The same on nodes, constant over them.
    const auto on_nodes = loads(field_of({make_zone(
                                    "base", points, faces, [](const Vector&) { return 0; },
                                    [](const Vector&) {
                                        return Vector{0, 0, 1};
                                    })}),
                                about({}));
    double triangles = 0;
    for (int i = 0; i < 6; ++i) {
        const Vector& a = points[static_cast<std::size_t>(i)];
        const Vector& b = points[static_cast<std::size_t>((i + 1) % 6)];
        triangles += 0.5 * norm(cross(plus(b, a, -1), plus(points[6], a, -1)));
    }
    EXPECT_NEAR(on_nodes.viscous.force[2], norm(area) + triangles, 1e-12);
    EXPECT_NEAR(on_nodes.area, norm(area) + triangles, 1e-12);
}

TEST(Loads, OfAHalfModelAreThoseOfTheWhole) {
    const auto p = [](const Vector& x) { return 30 * x[0] - 200 * x[2] + 1000 * x[0] * x[2] + 40; };
    const auto whole = loads(field_of({ellipsoid(30, {0.1, 0.08, 0.06}, p)}), about({0.01, 0, -0.02}));
    for (const bool turned : {false, true}) {
        const auto half =
            loads(field_of({ellipsoid(30, {0.1, 0.08, 0.06}, p, true, turned)}), about({0.01, 0, -0.02}, "y"));
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_NEAR(half.total.force[k], whole.total.force[k], 1e-9);
            EXPECT_NEAR(half.total.moment[k], whole.total.moment[k], 1e-10);
        }
        EXPECT_NEAR(half.area, whole.area, 1e-9);
        EXPECT_LT(half.closure, 1e-9);
        // A reference beside the plane moves the moment by r x F.
        const auto beside =
            loads(field_of({ellipsoid(30, {0.1, 0.08, 0.06}, p, true, turned)}), about({0.01, 0.5, -0.02}, "y"));
        EXPECT_NEAR(beside.total.moment[0], whole.total.moment[0] - 0.5 * whole.total.force[2], 1e-9);
    }
    const auto forgotten = loads(field_of({ellipsoid(30, {0.1, 0.08, 0.06}, p, true, true)}), about({0.01, 0, -0.02}));
    EXPECT_NEAR(2 * forgotten.total.force[2], whole.total.force[2],
                1e-9);  // the sides are settled also without the plane
    ASSERT_FALSE(forgotten.problems.empty());
    EXPECT_THAT(forgotten.problems.back().message, HasSubstr("option 'symmetry y'"));
    EXPECT_GT(forgotten.closure, 0.1);
    EXPECT_THROW(loads(field_of({ellipsoid(20, {0.1, 0.1, 0.1}, p)}), about({}, "y")), core::InputError);
    // Nor is it half a body that is open elsewhere than at its plane.
    EXPECT_THROW(loads(field_of({ellipsoid(20, {0.1, 0.1, 0.1}, p, true)}), about({}, "y=-1")), core::InputError);
}

TEST(Loads, OfTheShearOnAHalfModelAreThoseOfTheWhole) {
    // What mirroring at y = 0 leaves as it is: along x and z even, along y odd.
    const auto shear = [](const Vector& x) {
        return Vector{3 + 20 * x[0] + x[1] * x[1], 40 * x[1], 5 - 30 * x[2] * x[0]};
    };
    const auto p = [](const Vector& x) { return 100 * x[2]; };
    const auto whole =
        loads(field_of({ellipsoid(30, {0.1, 0.08, 0.06}, p, false, false, "hull", shear)}), about({0.01, 0, -0.02}));
    const auto half = loads(field_of({ellipsoid(30, {0.1, 0.08, 0.06}, p, true, false, "hull", shear)}),
                            about({0.01, 0, -0.02}, "y"));
    ASSERT_GT(std::abs(whole.viscous.force[0]), 0.01);
    ASSERT_GT(std::abs(whole.viscous.moment[1]), 1e-4);
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(half.viscous.force[k], whole.viscous.force[k], 1e-10);
        EXPECT_NEAR(half.viscous.moment[k], whole.viscous.moment[k], 1e-11);
    }
    // About another point: M' = M + (r - r') x F.
    const auto moved =
        loads(field_of({ellipsoid(30, {0.1, 0.08, 0.06}, p, false, false, "hull", shear)}), about({-0.3, 0.2, 0.5}));
    const Vector arm = {0.31, -0.2, -0.52};
    const Vector more = cross(arm, whole.total.force);
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(moved.total.moment[k], whole.total.moment[k] + more[k], 1e-12);
    }
}

/// A box whose top and bottom are zones of their own; any of them may lie the wrong way round.
Field box(bool turn_bottom, bool turn_top, bool without_top = false) {
    const std::vector<Vector> x = {{0, 0, 0},   {2, 0, 0},   {2, 1, 0},   {0, 1, 0},
                                   {0, 0, 0.5}, {2, 0, 0.5}, {2, 1, 0.5}, {0, 1, 0.5}};
    std::vector<std::vector<vtkIdType>> bottom = {{0, 3, 2, 1}};
    std::vector<std::vector<vtkIdType>> top = {{4, 5, 6, 7}};
    const auto turn = [](auto& faces) {
        std::for_each(faces.begin(), faces.end(), [](auto& f) { std::reverse(f.begin(), f.end()); });
    };
    if (turn_bottom) {
        turn(bottom);
    }
    if (turn_top) {
        turn(top);
    }
    const auto p = [](const Vector& q) { return 1 + q[2]; };
    std::vector<Zone> zones = {
        make_zone("base", {x[0], x[1], x[2], x[3]}, {{bottom[0][0], bottom[0][1], bottom[0][2], bottom[0][3]}}, p),
        make_zone("sides", x, {{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}, p)};
    if (!without_top) {
        zones.push_back(make_zone("top", {x[4], x[5], x[6], x[7]},
                                  {{top[0][0] - 4, top[0][1] - 4, top[0][2] - 4, top[0][3] - 4}}, p));
    }
    return field_of(std::move(zones));
}

TEST(Loads, SettleTheSidesOfEachZone) {
    for (int choice = 0; choice < 4; ++choice) {
        const auto result = loads(box((choice & 1) != 0, (choice & 2) != 0));
        EXPECT_NEAR(result.named.lift_force, 1.0 * 2 - 1.5 * 2, 1e-12) << choice;
        EXPECT_NEAR(result.closure, 0, 1e-12);
        EXPECT_EQ(result.zones[0].turned, (choice & 1) != 0);
        EXPECT_EQ(result.zones[2].turned, (choice & 2) != 0);
        EXPECT_THAT(result.reference_from, HasSubstr("zone 'base'"));
        EXPECT_NEAR(result.reference[0], 1, 1e-12);
        EXPECT_NEAR(result.reference[2], 0, 1e-12);
        const auto open = loads(box((choice & 1) != 0, false, true));
        EXPECT_NEAR(open.named.lift_force, 1.0 * 2, 1e-12);
        EXPECT_THAT(open.orientation, HasSubstr("share edges"));
        ASSERT_FALSE(open.problems.empty());
        EXPECT_THAT(open.problems.back().message, HasSubstr("not closed"));
        EXPECT_NEAR(open.force_per_reference_pascal[2], 2, 1e-12);
    }
}

Field box_over_ground(bool open) {
    Field field = box(false, false, open);
    field.zones.push_back(make_zone("ground", {{-9, -9, -1}, {9, -9, -1}, {9, 9, -1}, {-9, 9, -1}}, {{0, 1, 2, 3}},
                                    [](const Vector&) { return 1.0; }));
    return field;
}

TEST(Loads, AreThoseOfTheBodyAloneWhereAGroundIsAmongTheWalls) {
    const auto alone = loads(box(false, false));
    const auto result = loads(box_over_ground(false));
    EXPECT_EQ(result.total.force, alone.total.force);
    EXPECT_EQ(result.total.moment, alone.total.moment);
    EXPECT_NEAR(result.closure, 0, 1e-12);
    ASSERT_EQ(result.left_out.size(), 1U);
    EXPECT_EQ(result.left_out[0].name, "ground");
    ASSERT_FALSE(result.problems.empty());
    EXPECT_THAT(result.problems.back().message, HasSubstr("left out of the sum: zone 'ground': a plane of 324 m^2"));
    EXPECT_EQ(nlohmann::json(result)["left_out"][0]["name"], "ground");
}

TEST(Loads, LeaveOutWhatIsCalledAnInletWhereTheFileNamesNoWalls) {
    Field field = box(false, false, true);
    for (const char* name : {"inlet", "Outlet 2"}) {
        const double x = *name == 'i' ? -3 : 5;
        field.zones.push_back(make_zone(name, {{x, -1, 0}, {x, 1, 0}, {x, 1, 2}, {x, -1, 2}}, {{0, 1, 2, 3}},
                                        [](const Vector&) { return 7.0; }));
    }
    for (auto& zone : field.zones) {
        zone.kind = ZoneKind::unknown;
    }
    const auto alone = loads(box(false, false, true));
    const auto result = loads(field);
    EXPECT_EQ(result.total.force, alone.total.force);
    ASSERT_EQ(result.left_out.size(), 2U);
    EXPECT_EQ(result.left_out[1].name, "Outlet 2");
    EXPECT_THAT(result.left_out[1].why, HasSubstr("its name says that it is no wall: outlet"));
    LoadsOptions named;
    named.zones = {"*"};
    EXPECT_EQ(loads(field, named).total.force, alone.total.force);
    EXPECT_THAT(loads(field, named).left_out.at(0).why, HasSubstr("'*' takes walls, and this is inlet"));
    named.zones = {"*", "inlet"};
    EXPECT_EQ(loads(field, named).zones.size(), field.zones.size() - 1);
    named.zones = {"*let*"};  // no wall fits: it means these
    EXPECT_EQ(loads(field, named).zones.size(), 2U);
}

TEST(Loads, DoNotSeePointsThatNoFaceHas) {
    const auto alone = loads(box(false, false), {});
    Field field = box(false, false);
    for (auto& zone : field.zones) {
        zone.surface->GetPoints()->InsertNextPoint(-50, 20, -7);
        for (const char* name : {"pressure", "wall_shear"}) {
            auto* values = zone.surface->GetPointData()->GetArray(name);
            values->InsertNextTuple(std::vector<double>(3, 1e9).data());
        }
    }
    const auto result = loads(field, {});
    EXPECT_EQ(result.reference, alone.reference);
    EXPECT_EQ(result.total.force, alone.total.force);
    EXPECT_EQ(result.total.moment, alone.total.moment);
    EXPECT_EQ(result.centre_of_pressure, alone.centre_of_pressure);
}

/// A box with a group of its walls: the first so many faces of each zone, in one zone more, moved by `off`.
Field box_with_group(std::size_t sides, bool base, double off = 0) {
    Field field = box(false, false);
    std::vector<Vector> points;
    std::vector<std::vector<vtkIdType>> faces;
    std::size_t taken = 0;
    for (const auto& zone : field.zones) {
        for (vtkIdType f = 0; f < zone.surface->GetNumberOfPolys(); ++f) {
            vtkNew<vtkIdList> ids;
            zone.surface->GetPolys()->GetCellAtId(f, ids);
            if (zone.name == "base" ? !base : zone.name == "top" || taken++ >= sides) {
                continue;
            }
            faces.emplace_back();
            for (vtkIdType i = 0; i < ids->GetNumberOfIds(); ++i) {
                // Begun at another corner and with nodes of its own.
                Vector p{};
                zone.surface->GetPoint(ids->GetId((i + 1) % ids->GetNumberOfIds()), p.data());
                p[0] += off;
                faces.back().push_back(static_cast<vtkIdType>(points.size()));
                points.push_back(p);
            }
        }
    }
    field.zones.push_back(make_zone("Default", points, faces, [](const Vector& p) { return 1 + p[2]; }));
    return field;
}

TEST(Loads, CountFacesOnceThatStandTwiceInTheFile) {
    const auto alone = loads(box(false, false));
    for (const bool base : {false, true}) {
        for (const bool first : {false, true}) {  // the group before its members, or behind them
            Field field = box_with_group(9, base);
            if (first) {
                std::rotate(field.zones.begin(), field.zones.end() - 1, field.zones.end());
            }
            const auto result = loads(field, about({0, 0, 0}));
            EXPECT_NEAR(result.named.lift_force, alone.named.lift_force, 1e-12) << base << first;
            EXPECT_NEAR(result.area, alone.area, 1e-12);
            ASSERT_FALSE(result.left_out.empty());
            EXPECT_EQ(result.left_out[0].name == "Default", !first);
            EXPECT_EQ(result.left_out[0].by, LeftOutZone::By::doubled);
            EXPECT_TRUE(std::any_of(result.problems.begin(), result.problems.end(),
                                    [](const auto& p) { return p.message.find("left out of the sum: all ") == 0; }));
        }
    }
    // Named, it counts, and is said to.
    LoadsOptions all = about({0, 0, 0});
    all.zones = {"*"};
    const auto twice = loads(box_with_group(9, true), all);
    EXPECT_TRUE(std::any_of(twice.problems.begin(), twice.problems.end(),
                            [](const auto& p) { return p.message.find("counts twice") != std::string::npos; }));
    // Beside the walls it is no double of them.
    EXPECT_TRUE(loads(box_with_group(9, true, 1e-3), about({0, 0, 0})).left_out.empty());
}

TEST(Loads, OfZonesThatShareSomeOfTheirFacesAreRefused) {
    Field field = box(false, false);
    Zone& sides = field.zones[1];
    ASSERT_GT(sides.surface->GetNumberOfPolys(), 1);
    const auto overlap = make_zone("overlap", {{0, 0, 0}, {2, 0, 0}, {2, 0, 0.5}, {0, 0, 0.5}, {0, -1, 0}, {2, -1, 0}},
                                   {{0, 1, 2, 3}, {0, 4, 5, 1}}, [](const Vector& p) { return 1 + p[2]; });
    field.zones.push_back(overlap);
    try {
        loads(field);
        FAIL() << "accepted";
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.message(), HasSubstr("1 faces of zone"));
        EXPECT_THAT(error.message(), HasSubstr("overlap"));
    }
    // The other side of a thin wall looks the other way.
    field.zones.back() = make_zone("overlap", {{0, 0, 0}, {2, 0, 0}, {2, 0, 0.5}, {0, 0, 0.5}, {0, -1, 0}, {2, -1, 0}},
                                   {{3, 2, 1, 0}, {0, 4, 5, 1}}, [](const Vector& p) { return 1 + p[2]; });
    EXPECT_TRUE(loads(field).left_out.empty());
}

TEST(Loads, AreRefusedWhereNobodyCanTellWhatTheBodyIs) {
    try {
        loads(box_over_ground(true));
        FAIL() << "accepted";
    } catch (const core::InputError& error) {
        EXPECT_EQ(error.kind(), "zone");
        EXPECT_THAT(error.message(), HasSubstr("which walls are the body? zone 'ground'"));
        EXPECT_THAT(error.hint(), HasSubstr("option 'zones *'"));
    }
}

TEST(Loads, TakeEveryWallThatIsNamed) {
    LoadsOptions all;
    all.zones = {"*"};
    const auto result = loads(box_over_ground(false), all);
    EXPECT_TRUE(result.left_out.empty());
    EXPECT_EQ(result.zones.size(), 4U);
    ASSERT_FALSE(result.problems.empty());
    EXPECT_THAT(result.problems.back().message, HasSubstr("closes without zone 'ground'"));
}

TEST(Loads, SeeNoGroundInAPipeWithAFlange) {
    // Without the flange the area vectors of the pipe cancel, and still it is no body.
    std::vector<Vector> points;
    std::vector<std::vector<vtkIdType>> faces;
    constexpr vtkIdType around = 24;
    for (vtkIdType i = 0; i < 2 * around; ++i) {
        const double phi = 2 * M_PI * static_cast<double>(i % around) / around;
        points.push_back({i < around ? 0.0 : 3.0, std::cos(phi), std::sin(phi)});
    }
    for (vtkIdType i = 0; i < around; ++i) {
        faces.push_back({i, (i + 1) % around, around + (i + 1) % around, around + i});
    }
    const auto p = [](const Vector&) { return 5.0; };
    LoadsOptions all = about({});
    all.zones = {"*"};
    const auto result =
        loads(field_of({make_zone("pipe", points, faces, p),
                        make_zone("flange", {{3, -2, -2}, {3, 2, -2}, {3, 2, 2}, {3, -2, 2}}, {{0, 1, 2, 3}}, p)}),
              all);
    ASSERT_FALSE(result.problems.empty());
    EXPECT_THAT(result.problems.back().message,
                testing::AllOf(HasSubstr("not closed"), testing::Not(HasSubstr("a ground?"))));
}

/// Two boxes of one zone, the second at x + 5, with a winding of its own; `around` makes it a tank around the first
/// instead.
Field two_boxes(bool turned, bool around) {
    std::vector<Vector> points;
    std::vector<std::vector<vtkIdType>> faces = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                                 {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    for (const bool second : {false, true}) {
        for (const double z : {0.0, 0.5}) {
            for (const auto& [x, y] : {std::pair{0.0, 0.0}, {2.0, 0.0}, {2.0, 1.0}, {0.0, 1.0}}) {
                points.push_back(!second  ? Vector{x, y, z}
                                 : around ? Vector{6 * x - 4, 6 * y - 2, 6 * z - 1}
                                          : Vector{x / 2 + 5, y, z});
            }
        }
    }
    for (std::size_t i = 0; i < 6; ++i) {
        faces.push_back(faces[i]);
        std::for_each(faces.back().begin(), faces.back().end(), [](vtkIdType& node) { node += 8; });
        if (turned) {
            std::reverse(faces.back().begin(), faces.back().end());
        }
    }
    return field_of(
        {make_zone("walls", points, faces, [](const Vector& p) { return 10 + 2 * p[0] - 3 * p[1] + 4 * p[2]; })});
}

TEST(Loads, OfSeveralBodiesInOneZoneDoNotDependOnTheWindingOfEach) {
    for (const bool turned : {false, true}) {
        const auto result = loads(two_boxes(turned, false), about({0, 0, 0}));
        ASSERT_EQ(result.zones.size(), 1U);
        EXPECT_EQ(result.zones[0].faces, 12U);
        for (const auto& [k, slope] : {std::pair{0, 2.0}, {1, -3.0}, {2, 4.0}}) {
            EXPECT_NEAR(result.total.force[static_cast<std::size_t>(k)], -slope * 1.5, 1e-12) << turned;  // -grad p V
        }
        const auto inside = loads(two_boxes(turned, true), about({0, 0, 0}));
        EXPECT_NEAR(inside.total.force[2], -4.0, 1e-12) << turned;
        ASSERT_EQ(inside.left_out.size(), 1U);
        EXPECT_EQ(inside.left_out[0].name, "walls (part 2 of 2)");
    }
}

TEST(Loads, KnowTheTimeOfTheirField) {
    Field field = box(false, false);
    EXPECT_FALSE(loads(field, about({0, 0, 0})).time);
    field.metadata = {{"flow-time", "0"}};  // a steady run
    EXPECT_FALSE(loads(field, about({0, 0, 0})).time);
    field.metadata = {{"flow-time", "0.25"}};
    EXPECT_EQ(loads(field, about({0, 0, 0})).time, 0.25);
    field.metadata = {{"time", "0"}};
    EXPECT_EQ(loads(field, about({0, 0, 0})).time, 0.0);
}

TEST(Loads, SayThatTheSideOfADuctIsNotKnown) {
    for (const bool turned : {false, true}) {
        Field duct = box(false, false);
        duct.zones = {duct.zones[1]};  // open below and above
        if (turned) {
            duct.zones[0].surface->GetPolys()->ReverseCellAtId(0);
            duct.zones[0].surface->GetPolys()->ReverseCellAtId(1);
            duct.zones[0].surface->GetPolys()->ReverseCellAtId(2);
            duct.zones[0].surface->GetPolys()->ReverseCellAtId(3);
        }
        const auto result = loads(duct, about({0, 0, 0}));
        ASSERT_FALSE(result.problems.empty());
        EXPECT_THAT(result.problems.front().message,
                    testing::AllOf(HasSubstr("as those of a duct"), HasSubstr("option 'fluid file'")));
        EXPECT_EQ(result.zones[0].turned, turned);
        EXPECT_THAT(result.orientation, testing::Not(HasSubstr("closes")));
    }
    const auto closed = loads(box(true, false), about({0, 0, 0}));
    EXPECT_TRUE(std::none_of(closed.problems.begin(), closed.problems.end(),
                             [](const auto& p) { return p.message.find("duct") != std::string::npos; }));
}

TEST(Loads, TakeTheSidesAsToldWhenTold) {
    LoadsOptions options;
    options.fluid = FluidSide::as_in_file;
    EXPECT_NEAR(loads(box(true, false), options).named.lift_force, -2 - 3, 1e-12);
    options.fluid = FluidSide::reversed;
    EXPECT_NEAR(loads(box(true, false), options).named.lift_force, 2 + 3, 1e-12);
}

TEST(Loads, SayThatAPlateAloneHasNoSide) {
    const auto plate = make_zone("base", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2, 3}},
                                 [](const Vector&) { return 7.0; });
    const auto result = loads(field_of({plate}));
    ASSERT_FALSE(result.problems.empty());
    EXPECT_THAT(result.problems[0].message, HasSubstr("cannot be told from its shape"));
    EXPECT_NEAR(std::abs(result.named.lift_force), 7, 1e-12);
}

TEST(Loads, IntegrateLinearValuesExactlyOverEveryPolygon) {
    // A plane hexagon, a quad, a triangle; p = a + b x, so that F and M are the polygon's moments in closed form.
    const std::vector<std::vector<Vector>> polygons = {
        {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}},
        {{0, 0, 0}, {2, 0, 0}, {3, 2, 0}, {0, 1, 0}},
        {{0, 0, 0}, {1, -1, 0}, {3, 0, 0}, {3, 2, 0}, {1, 3, 0}, {0, 2, 0}}};
    for (const auto& polygon : polygons) {
        double area = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;  // by Green's theorem
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const auto& a = polygon[i];
            const auto& b = polygon[(i + 1) % polygon.size()];
            const double w = a[0] * b[1] - b[0] * a[1];
            area += w / 2;
            sx += w * (a[0] + b[0]) / 6;
            sy += w * (a[1] + b[1]) / 6;
            sxx += w * (a[0] * a[0] + a[0] * b[0] + b[0] * b[0]) / 12;
            sxy += w * (a[0] * b[1] + 2 * a[0] * a[1] + 2 * b[0] * b[1] + b[0] * a[1]) / 24;
        }
        std::vector<vtkIdType> face(polygon.size());
        std::iota(face.begin(), face.end(), vtkIdType{0});
        LoadsOptions options = about({});
        options.fluid = FluidSide::as_in_file;
        const auto shear = [](const Vector& q) { return Vector{2 + 3 * q[0], 0, 1}; };
        const auto result = loads(field_of({make_zone(
                                      "a", polygon, {face}, [](const Vector& q) { return 5 + 7 * q[0]; }, shear)}),
                                  options);
        const double force = -(5 * area + 7 * sx);
        const bool quad = polygon.size() == 4;  // a bilinear map is not linear in x over a general quad, only nearly
        EXPECT_NEAR(result.pressure.force[2], force, quad ? 2e-12 : 1e-12);
        EXPECT_NEAR(result.pressure.moment[0], -(5 * sy + 7 * sxy), 1e-9);
        EXPECT_NEAR(result.pressure.moment[1], 5 * sx + 7 * sxx, 1e-9);
        EXPECT_NEAR(result.viscous.force[0], 2 * area + 3 * sx, 1e-9);
        EXPECT_NEAR(result.viscous.moment[1], -(sx), 1e-9);
        EXPECT_NEAR(result.viscous.moment[2], -(2 * sy + 3 * sxy), 1e-9);
        EXPECT_NEAR(result.area, area, 1e-12);
    }
}

TEST(Loads, OfAWarpedQuadAreThoseOfItsBilinearPatch) {
    core::Random random(2);
    for (int trial = 0; trial < 20; ++trial) {
        std::vector<Vector> x = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
        std::vector<double> p;
        for (auto& q : x) {
            for (auto& c : q) {
                c += 0.3 * random.normal();
            }
            p.push_back(random.normal());
        }
        // The patch in small pieces.
        Vector force{};
        Vector moment{};
        constexpr int n = 160;
        const auto mix = [&](auto get, double u, double v) {
            return (1 - u) * (1 - v) * get(0) + u * (1 - v) * get(1) + u * v * get(2) + (1 - u) * v * get(3);
        };
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < n; ++j) {
                const double u = (i + 0.5) / n;
                const double v = (j + 0.5) / n;
                Vector q{}, du{}, dv{};
                for (std::size_t k = 0; k < 3; ++k) {
                    q[k] = mix([&](std::size_t m) { return x[m][k]; }, u, v);
                    du[k] = (1 - v) * (x[1][k] - x[0][k]) + v * (x[2][k] - x[3][k]);
                    dv[k] = (1 - u) * (x[3][k] - x[0][k]) + u * (x[2][k] - x[1][k]);
                }
                const double value = mix([&](std::size_t m) { return p[m]; }, u, v) / (n * n);
                const Vector f = {-value * (du[1] * dv[2] - du[2] * dv[1]), -value * (du[2] * dv[0] - du[0] * dv[2]),
                                  -value * (du[0] * dv[1] - du[1] * dv[0])};
                for (std::size_t k = 0; k < 3; ++k) {
                    force[k] += f[k];
                }
                moment[0] += q[1] * f[2] - q[2] * f[1];
                moment[1] += q[2] * f[0] - q[0] * f[2];
                moment[2] += q[0] * f[1] - q[1] * f[0];
            }
        }
        std::size_t next = 0;
        LoadsOptions options = about({});
        options.fluid = FluidSide::as_in_file;
        const auto result =
            loads(field_of({make_zone("a", x, {{0, 1, 2, 3}}, [&](const Vector&) { return p[next++]; })}), options);
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_NEAR(result.pressure.force[k], force[k], 1e-4);
            EXPECT_NEAR(result.pressure.moment[k], moment[k], 2e-4);
        }
    }
}

TEST(Loads, TurnWithTheAxesAndKeepTheVehiclesSense) {
    // A push at the bow upward, seen with other axes: forward -y, up +x of the file.
    const Vector axes = {0.1, 0.1, 0.1};
    const auto p = [](const Vector& x) { return 1000 * x[0] * x[0] * x[0] + 100 * x[0] * x[1]; };
    LoadsOptions options = about({});
    options.forward = axis_from("-y");
    options.up = axis_from("x");
    const auto result = loads(field_of({ellipsoid(30, axes, p)}), options);
    EXPECT_NEAR(result.named.lift_force, result.total.force[0], 1e-15);
    EXPECT_NEAR(result.named.drag_force, result.total.force[1], 1e-15);
    EXPECT_NEAR(result.named.side_force, result.total.force[2], 1e-15);  // (-y) x (x) = z is starboard
    EXPECT_THROW(axis_from("q"), core::UsageError);
    options.up = axis_from("y");
    EXPECT_THROW(loads(field_of({ellipsoid(10, axes, p)}), options), core::UsageError);
}

TEST(Loads, AreTheSameWithAnyNumberOfThreads) {
    const Field field =
        field_of({ellipsoid(300, {0.1, 0.08, 0.06}, [](const Vector& x) { return std::sin(50 * x[0]) + x[2]; })});
    core::set_threads(1);
    const auto one = loads(field, about({}));
    core::set_threads(4);
    const auto four = loads(field, about({}));
    core::set_threads(0);
    EXPECT_EQ(one.total.force, four.total.force);
    EXPECT_EQ(one.total.moment, four.total.moment);
}

TEST(Loads, PreferFaceValuesAndSayWhereValuesCameFrom) {
    Field field = box(false, false);
    for (auto& zone : field.zones) {
        vtkNew<vtkDoubleArray> on_faces;
        on_faces->SetName("pressure");
        on_faces->SetNumberOfTuples(zone.surface->GetNumberOfPolys());
        on_faces->Fill(zone.name == "base" ? 10 : 0);
        zone.surface->GetCellData()->AddArray(on_faces);
        zone.arrays[0].on = Location::faces;
    }
    const auto result = loads(field);
    EXPECT_EQ(result.values_from, "faces");
    EXPECT_NEAR(result.named.lift_force, 20, 1e-12);
}

TEST(Loads, RefuseWhatCannotBeIntegrated) {
    const auto message = [](const Field& field, const LoadsOptions& options = {}) {
        try {
            loads(field, options);
        } catch (const core::InputError& error) {
            return std::string(error.what());
        }
        return std::string("no error");
    };
    Field missing = box(false, false);
    missing.zones[1].surface->GetPointData()->GetArray("pressure")->SetComponent(3, 0, NAN);
    EXPECT_THAT(message(missing), HasSubstr("zone 'sides': pressure has no finite value at node 3"));
    Field points = box(false, false);
    points.zones[0].surface->SetPolys(vtkNew<vtkCellArray>());
    points.zones[0].kind = ZoneKind::wall;
    EXPECT_THAT(message(points), HasSubstr("has no faces"));
    Field bare = box(false, false);
    bare.zones[0].surface->GetPointData()->RemoveArray("pressure");
    EXPECT_THAT(message(bare), HasSubstr("zone 'base' has no pressure"));
    Field damaged = box(false, false);
    damaged.problems.push_back({core::Problem::Severity::error, "a face has no area", {"made.csv", 17, {}, {}}});
    EXPECT_THAT(message(damaged), HasSubstr("made.csv:17: a face has no area"));
    LoadsOptions accept;
    accept.accept_problems = true;
    EXPECT_EQ(message(damaged, accept), "no error");
    LoadsOptions zones;
    zones.zones = {"bse"};
    EXPECT_THAT(message(box(false, false), zones), HasSubstr("did you mean 'base'?"));
}

TEST(Loads, SayHowToGiveTheUnitOfAPressureWithoutOne) {
    Field field = box(false, false);
    for (auto& zone : field.zones) {
        zone.surface->GetPointData()->GetArray("pressure")->SetName("p (unit not stated)");
        zone.arrays[0] = {"p (unit not stated)", "", "p", "", Location::nodes, 1};
    }
    try {
        loads(field);
        FAIL() << "accepted";
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.message(), HasSubstr("has no pressure but 'p'"));
        EXPECT_THAT(error.hint(), HasSubstr("option 'unit p=Pa'"));
        EXPECT_THAT(error.hint(), HasSubstr("option 'unit p=m^2/s^2' with option 'density'"));
    }
}

TEST(Loads, GiveCoefficientsAndTheRunningIntegral) {
    LoadsOptions options = about({0, 0, 0});
    options.references = {1000, 2.0, 0.2, 0.16, 0.12};
    options.stations = 10;
    const auto result = loads(field_of({ellipsoid(40, {0.1, 0.08, 0.06}, hydrostatic)}), options);
    ASSERT_TRUE(result.coefficients);
    EXPECT_NEAR(result.coefficients->lift, result.named.lift_force / (0.5 * 1000 * 4 * M_PI / 4 * 0.2 * 0.16), 1e-12);
    ASSERT_EQ(result.stations.size(), 11U);
    EXPECT_NEAR(result.stations.back().behind.lift_force, result.named.lift_force, 1e-9);
    EXPECT_NEAR(result.stations[5].behind.lift_force, 0.5 * result.named.lift_force, 0.03 * result.named.lift_force);
    const nlohmann::json json = result;
    for (const char* key : {"force", "moment", "reference", "pressure", "viscous", "lift_force", "drag_force",
                            "side_force", "pitch_moment", "roll_moment", "yaw_moment", "coefficients", "zones",
                            "closure", "force_per_reference_pascal", "values_from"}) {
        EXPECT_TRUE(json.contains(key)) << key;
    }
    EXPECT_EQ(json["pressure"]["force"].size(), 3U);
}

TEST(Loads, OfAWholeBodyAreNotDoubled) {
    try {
        (void)loads(box(false, false), about({0, 0, 0}, "z"));
        ADD_FAILURE() << "a closed box passed for half of one";
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.what(),
                    testing::AllOf(HasSubstr("closes without a mirror image"), HasSubstr("option 'symmetry z=0'")));
    }
    EXPECT_NO_THROW((void)loads(box(false, false), about({0, 0, 0}, "z=-1")));
}

TEST(Loads, TellAGroundFromThePlaneOfAHalfModel) {
    // A body over a ground at z = 0, in one zone: open along z, and no half of anything.
    std::vector<Vector> points = {{0, 0, 0.1}, {2, 0, 0.1}, {2, 1, 0.1}, {0, 1, 0.1}, {0, 0, 0.6}, {2, 0, 0.6},
                                  {2, 1, 0.6}, {0, 1, 0.6}, {-1, -1, 0}, {3, -1, 0},  {3, 2, 0},   {-1, 2, 0}};
    const std::vector<std::vector<vtkIdType>> faces = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},  {1, 2, 6, 5},
                                                       {2, 3, 7, 6}, {3, 0, 4, 7}, {8, 9, 10, 11}};
    const Field field = field_of({make_zone("walls", points, faces, [](const Vector& p) { return 1 + p[2]; })});
    for (const auto& problem : loads(field, about({0, 0, 0})).problems) {
        EXPECT_THAT(problem.message, testing::Not(HasSubstr("half model")));
    }
    EXPECT_THROW((void)loads(field, about({0, 0, 0}, "z")), core::InputError);
}

TEST(Loads, OfTwoHullsSideBySideHaveTheWidthOfBoth) {
    LoadsOptions options = about({0, 0, 0});
    options.symmetry = "y=0";
    options.references.density = 1000;
    options.references.speed = 1;
    Field twin = box(false, false);  // y from 0 to 1: moved to 2 to 3, its image from -3 to -2
    for (auto& zone : twin.zones) {
        for (vtkIdType i = 0; i < zone.surface->GetNumberOfPoints(); ++i) {
            double x[3];
            zone.surface->GetPoint(i, x);
            zone.surface->GetPoints()->SetPoint(i, x[0], x[1] + 2, x[2]);
        }
    }
    const auto result = loads(twin, options);
    ASSERT_TRUE(result.coefficients);
    EXPECT_NEAR(result.coefficients->width, 6, 1e-12);
}

TEST(Loads, OfAPlaneCaseArePerMetreDepth) {
    // A circle of lines, p = -rho g y: buoyancy per metre is rho g times the polygon's area.
    constexpr int count = 90;
    for (const bool known : {true, false}) {
        Zone zone;
        zone.name = "cylinder";
        zone.kind = ZoneKind::wall;
        zone.normals_into_fluid = known;
        zone.surface = vtkSmartPointer<vtkPolyData>::New();
        vtkNew<vtkPoints> points;
        points->SetDataTypeToDouble();
        vtkNew<vtkCellArray> lines;
        vtkNew<vtkDoubleArray> pressure;
        pressure->SetName("pressure");
        for (int i = 0; i < count; ++i) {
            const double at = 2 * M_PI * i / count;
            const double next = 2 * M_PI * (i + 1) / count;
            points->InsertNextPoint(0.1 * std::cos(at), 0.1 * std::sin(at), 0);
            // z x t looks out of the circle when it is run through clockwise.
            lines->InsertNextCell({static_cast<vtkIdType>((i + 1) % count), static_cast<vtkIdType>(i)});
            pressure->InsertNextValue(-rho * g * 0.05 * (std::sin(at) + std::sin(next)));
        }
        zone.surface->SetPoints(points);
        zone.surface->SetLines(lines);
        zone.surface->GetCellData()->AddArray(pressure);
        zone.arrays = {{"pressure", "Pa", "SV_P", "", Location::faces, 1}};
        Field field = field_of({zone});
        field.dimension = 2;
        const auto result = loads(field, about({}));
        LoadsOptions aside = about({});
        aside.forward = {0, 1, 0};  // the default up leaves the plane: +x is what is left
        EXPECT_NEAR(loads(field, aside).named.drag_force, -result.named.lift_force, 1e-12);
        aside.forward = {0, 0, -1};
        EXPECT_THROW((void)loads(field, aside), core::UsageError);
        const double area = 0.5 * count * 0.01 * std::sin(2 * M_PI / count);
        EXPECT_NEAR(result.total.force[1], rho * g * area, 1e-9);
        EXPECT_NEAR(result.named.lift_force, rho * g * area, 1e-9);
        EXPECT_LT(result.closure, 1e-12);
        EXPECT_EQ(result.dimension, 2);
        EXPECT_EQ(result.values_from, "faces");
    }
}

/// A profile y(x) of lines from the tail to the nose, z x t looks out of it; node values.
Field profile(const std::vector<std::array<double, 2>>& places, const PointFunction& pressure, const Vector& shear,
              bool known) {
    Zone zone;
    zone.name = "body";
    zone.kind = ZoneKind::wall;
    zone.normals_into_fluid = known;
    zone.surface = vtkSmartPointer<vtkPolyData>::New();
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    vtkNew<vtkCellArray> lines;
    vtkNew<vtkDoubleArray> values;
    values->SetName("pressure");
    vtkNew<vtkDoubleArray> tractions;
    tractions->SetName("wall_shear");
    tractions->SetNumberOfComponents(3);
    for (std::size_t i = 0; i < places.size(); ++i) {
        points->InsertNextPoint(places[i][0], places[i][1], 0);
        values->InsertNextValue(pressure({places[i][0], places[i][1], 0}));
        tractions->InsertNextTuple(shear.data());
        if (i > 0) {
            const auto n = static_cast<vtkIdType>(i);
            lines->InsertNextCell({known ? n - 1 : n, known ? n : n - 1});
        }
    }
    zone.surface->SetPoints(points);
    zone.surface->SetLines(lines);
    zone.surface->GetPointData()->AddArray(values);
    zone.surface->GetPointData()->AddArray(tractions);
    zone.arrays = {{"pressure", "Pa", "p", "", Location::nodes, 1}, {"wall_shear", "Pa", "t", "", Location::nodes, 3}};
    Field field = field_of({zone});
    field.dimension = 2;
    return field;
}

TEST(Loads, OfAnAxisymmetricCaseAreThoseOfTheBodyOfRevolution) {
    std::vector<std::array<double, 2>> sphere;
    constexpr int count = 40;
    for (int i = 0; i <= count; ++i) {
        const double at = M_PI * (1 - static_cast<double>(i) / count);
        sphere.push_back({0.3 + 0.1 * std::cos(at), i == 0 || i == count ? 0 : 0.1 * std::sin(at)});
    }
    double volume = 0, area = 0, swirl = 0;  // of the cones between two places
    for (std::size_t i = 1; i < sphere.size(); ++i) {
        const double r0 = sphere[i - 1][1], r1 = sphere[i][1];
        const double height = sphere[i][0] - sphere[i - 1][0];
        const double slant = std::hypot(height, r1 - r0);
        volume += M_PI / 3 * height * (r0 * r0 + r0 * r1 + r1 * r1);
        area += M_PI * (r0 + r1) * slant;
        swirl += 2 * M_PI / 3 * slant * (r0 * r0 + r0 * r1 + r1 * r1);
    }
    const auto p = [](const Vector& x) { return 700 - 2000 * x[0]; };
    for (const bool known : {true, false}) {
        Field field = profile(sphere, p, {3, 5, 7}, known);
        LoadsOptions options = about({0.05, 0.02, 0});
        options.references = {1000, 1.0, {}, {}, {}};
        options.stations = 4;
        EXPECT_EQ(loads(field, options).depth, "per metre depth");  // until somebody says what it is
        field.metadata = {{"axisymmetric", "true"}};
        const auto result = loads(field, options);
        EXPECT_EQ(result.depth, "of the whole body of revolution");
        EXPECT_NEAR(result.pressure.force[0], 2000 * volume, 1e-12);
        EXPECT_NEAR(result.viscous.force[0], 3 * area, 1e-12);
        EXPECT_EQ(result.total.force[1], 0);  // round the axis it cancels
        EXPECT_EQ(result.total.force[2], 0);
        EXPECT_NEAR(result.area, area, 1e-12);
        EXPECT_NEAR(result.total.moment[0], 7 * swirl, 1e-12);
        EXPECT_NEAR(result.total.moment[2], 0.02 * result.total.force[0],
                    1e-12);  // the axis passes the reference 0.02 m below it
        EXPECT_LT(result.closure, 1e-12);
        EXPECT_NEAR(result.named.drag_force, -result.total.force[0], 1e-12);
        ASSERT_TRUE(result.coefficients);
        EXPECT_NEAR(result.coefficients->width, 0.2, 1e-12);
        EXPECT_NEAR(result.coefficients->drag, result.named.drag_force / (500 * M_PI * 0.01), 1e-9);
        EXPECT_NEAR(result.stations.back().behind.drag_force, result.named.drag_force, 1e-12);
        field.metadata.clear();
        options.axisymmetric = true;
        EXPECT_EQ(loads(field, options).total.force, result.total.force);
        // Forces on faces that may be per radian are no traction: left out, aloud.
        field.zones[0].arrays[1].original_unit = "N";
        const auto without = loads(field, options);
        EXPECT_EQ(without.viscous.force, Vector{});
        EXPECT_THAT(without.problems.back().message, HasSubstr("per radian"));
        options.symmetry = "y";
        EXPECT_THROW(loads(field, options), core::UsageError);
    }
    Field below = profile({{0, -0.1}, {1, 0.2}}, p, {}, true);
    LoadsOptions options;
    options.axisymmetric = true;
    EXPECT_THROW(loads(below, options), core::InputError);
}

TEST(Loads, OfHalfAPlaneCaseAreThoseOfTheWhole) {
    // The upper half of a cylinder, p = c - b x: 2 b times the half's area along x, per metre.
    std::vector<std::array<double, 2>> places;
    constexpr int count = 60;
    for (int i = 0; i <= count; ++i) {
        const double at = M_PI * (1 - static_cast<double>(i) / count);
        places.push_back({0.1 * std::cos(at), i == 0 || i == count ? 0 : 0.1 * std::sin(at)});
    }
    const double area = 0.5 * count * 0.01 * std::sin(M_PI / count);
    for (const bool known : {true, false}) {
        const auto half = loads(profile(
                                    places, [](const Vector& x) { return 50 - 2000 * x[0]; }, {4, 0, 0}, known),
                                about({}, "y"));
        EXPECT_NEAR(half.pressure.force[0], 2 * 2000 * area, 1e-9);
        EXPECT_NEAR(half.viscous.force[0], 2 * 4 * count * 0.2 * std::sin(M_PI / count / 2), 1e-9);
        EXPECT_EQ(half.total.force[1], 0);
        EXPECT_LT(half.closure, 1e-12);
        EXPECT_EQ(half.depth, "per metre depth");
    }
}

TEST(Loads, OfAnOpenSurfaceAreAuditedAgainstAbsolutePressureToo) {
    // One atmosphere and 20 Pa of flow on half an ellipsoid: a kilopascal is less than 1 % of that force, and fifty
    // times the flow's.
    const auto absolute = loads(field_of({ellipsoid(
                                    30, {0.1, 0.08, 0.06}, [](const Vector& x) { return 101325 + 200 * x[0]; }, true)}),
                                about({}));
    ASSERT_FALSE(absolute.problems.empty());
    EXPECT_THAT(absolute.problems.back().message, HasSubstr("not closed"));
    // Closed, it does not matter.
    const auto closed = loads(
        field_of({ellipsoid(30, {0.1, 0.08, 0.06}, [](const Vector& x) { return 101325 + 200 * x[0]; })}), about({}));
    EXPECT_TRUE(closed.problems.empty());
    LoadsOptions options = about({});
    options.reference_pressure = 101325;
    const auto gauge = loads(
        field_of({ellipsoid(30, {0.1, 0.08, 0.06}, [](const Vector& x) { return 101325 + 200 * x[0]; })}), options);
    EXPECT_NEAR(gauge.total.force[0], closed.total.force[0], 1e-8);
}

TEST(Loads, BringAbsolutePressuresAndGaugeOnesTogetherOrRefuse) {
    Field field = box(false, false);
    auto* top = field.zones[2].surface->GetPointData()->GetArray("pressure");
    top->SetName("pressure_absolute");
    for (vtkIdType i = 0; i < top->GetNumberOfTuples(); ++i) {
        top->SetComponent(i, 0, top->GetComponent(i, 0) + 101325);
    }
    EXPECT_THROW(loads(field), core::InputError);
    field.pressure = {PressureReference::Kind::gauge, 101325};
    const auto result = loads(field);
    EXPECT_NEAR(result.named.lift_force, -1, 1e-9);
    ASSERT_FALSE(result.problems.empty());
    EXPECT_THAT(result.problems.front().message, HasSubstr("101325 Pa"));
}

TEST(Loads, TakeTheValuesOfFacesBehindThoseOfLines) {
    Field field = box(false, false);
    for (auto& zone : field.zones) {
        vtkNew<vtkCellArray> lines;
        lines->InsertNextCell({0, 1});
        zone.surface->SetLines(lines);
        vtkNew<vtkDoubleArray> on_cells;  // VTK counts lines before polygons
        on_cells->SetName("pressure");
        on_cells->InsertNextValue(1e6);
        for (vtkIdType i = 0; i < zone.surface->GetNumberOfPolys(); ++i) {
            on_cells->InsertNextValue(zone.name == "base" ? 10 : 0);
        }
        zone.surface->GetCellData()->AddArray(on_cells);
        zone.arrays[0].on = Location::faces;
    }
    EXPECT_NEAR(loads(field).named.lift_force, 20, 1e-12);
    for (auto& zone : field.zones) {  // with a point that no face has, too
        zone.surface->GetPoints()->InsertNextPoint(-50, 20, -7);
        zone.surface->GetPointData()->GetArray("wall_shear")->InsertNextTuple3(0, 0, 0);
        zone.surface->GetPointData()->RemoveArray("pressure");
    }
    EXPECT_NEAR(loads(field).named.lift_force, 20, 1e-12);
}

TEST(Loads, HaveNoCentreOfPressureWithoutLift) {
    const auto drag_only =
        loads(field_of({ellipsoid(30, {0.1, 0.08, 0.06}, [](const Vector& x) { return 100 * x[0]; })}), about({}));
    EXPECT_FALSE(drag_only.centre_of_pressure);
    // Buoyancy of a body shifted forward acts at its centroid, wherever moments are taken.
    Zone shifted = ellipsoid(30, {0.1, 0.08, 0.06}, hydrostatic);
    for (vtkIdType i = 0; i < shifted.surface->GetNumberOfPoints(); ++i) {
        double x[3];
        shifted.surface->GetPoint(i, x);
        shifted.surface->GetPoints()->SetPoint(i, x[0] + 0.25, x[1], x[2]);
    }
    for (const double reference : {-1.0, 0.0, 0.4}) {
        const auto result = loads(field_of({shifted}), about({reference, 0, 0.3}));
        ASSERT_TRUE(result.centre_of_pressure);
        EXPECT_NEAR((*result.centre_of_pressure)[0], 0.25, 1e-9);
        EXPECT_NEAR(result.named.pitch_moment, (0.25 - reference) * result.named.lift_force, 1e-9);
    }
}

TEST(LoadsTable, HasOneRowACaseWithItsConditions) {
    const auto result = loads(box(false, false));
    const core::Table table = loads_table({{"a.csv", {{"gap", 0.005}}, {{"variant", "ellipse"}}, result, {}, {}},
                                           {"b.csv", {{"gap", 0.01}, {"lift_force", 1.0}}, {}, result, {}, {}}},
                                          {{"gap", "mm"}});
    EXPECT_EQ(table.rows(), 2U);
    EXPECT_EQ(table.find("gap")->written_unit, "mm");
    EXPECT_EQ(table.numbers("gap")[1], 0.01);
    EXPECT_EQ(table.text("variant")[0], "ellipse");
    EXPECT_NEAR(table.numbers("lift_force")[0], -1, 1e-12);
    EXPECT_EQ(table.numbers("lift_force_stated")[1], 1.0);
    EXPECT_TRUE(std::isnan(table.numbers("lift_force_stated")[0]));
}

}  // namespace
}  // namespace underbody::postproc
