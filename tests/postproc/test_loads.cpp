// Loads against closed forms.
#include <gmock/gmock.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/parallel.h"
#include "core/random.h"
#include "postproc/loads/loads.h"
#include "tests/postproc/made_zones.h"

namespace underbody::postproc {
namespace {

using testing::HasSubstr;

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

std::size_t lone_values(const LoadsResult& result, std::string* text = nullptr) {
    std::size_t count = 0;
    for (const auto& problem : result.problems) {
        if (problem.message.find("such a value decides the force") != std::string::npos) {
            ++count;
            EXPECT_EQ(problem.severity, core::Problem::Severity::warning);
            if (text != nullptr) {
                *text = problem.message;
            }
        }
    }
    return count;
}

TEST(Loads, WarnOfAPressureFarFromAllOthers) {
    const Vector axes = {0.1, 0.07, 0.05};
    for (const int spikes : {0, 1, 3}) {
        Field field = field_of({ellipsoid(60, axes, hydrostatic)});
        auto* values = vtkDoubleArray::SafeDownCast(field.zones[0].surface->GetPointData()->GetArray("pressure"));
        for (int i = 0; i < spikes; ++i) {
            values->SetValue(100 + 7 * i, 1e9);
        }
        std::string text;
        EXPECT_EQ(lone_values(loads(field, about({})), &text), spikes > 0 ? 1U : 0U) << text;
        if (spikes > 0) {
            EXPECT_THAT(text, HasSubstr("1e+09 Pa at node 100 of zone 'hull'"));
            EXPECT_EQ(text.find("2 other places") != std::string::npos, spikes == 3) << text;
        }
    }
    // An edge that sucks hard, as flows have it, is none; nor is one pressure everywhere, or two of them.
    const auto edge = [](const Vector& p) { return 100 / std::pow(std::abs(p[0] - 0.09) + 1e-4, 0.7); };
    const auto halves = [](const Vector& p) { return p[0] > 0 ? 101325.0 : 0.0; };
    for (const PointFunction& pressure :
         {PointFunction(edge), PointFunction(halves), PointFunction([](const Vector&) { return 5.0; })}) {
        EXPECT_EQ(lone_values(loads(field_of({ellipsoid(60, axes, pressure)}), about({}))), 0U);
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

}  // namespace
}  // namespace underbody::postproc
