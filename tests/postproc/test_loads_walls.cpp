// Which walls the loads are of, and which way their faces look.
#include <gmock/gmock.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "postproc/loads/loads.h"
#include "tests/postproc/made_zones.h"

namespace underbody::postproc {
namespace {

using testing::HasSubstr;

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
        EXPECT_THAT(error.message(), HasSubstr("1 face of zone"));
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

TEST(Loads, OfABaseAloneAreThoseItHasInTheWholeBody) {
    for (const bool base_turned : {false, true}) {
        for (const bool side_turned : {false, true}) {
            const Field field = box(base_turned, side_turned);
            const auto whole = loads(field);
            LoadsOptions options;
            options.zones = {"base"};
            const auto alone = loads(field, options);
            const auto& base = *std::find_if(whole.zones.begin(), whole.zones.end(),
                                             [](const ZoneLoads& zone) { return zone.name == "base"; });
            ASSERT_GT(std::abs(base.pressure.force[2]), 0.1);
            EXPECT_NEAR(alone.named.lift_force, base.pressure.force[2] + base.viscous.force[2], 1e-12);
            EXPECT_THAT(alone.orientation, HasSubstr("not summed"));
        }
    }
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
    LoadsOptions half = about({0, 0, 0}, "z");
    half.up = axis_from("+y");  // the plane lies along the vehicle
    EXPECT_THROW((void)loads(field, half), core::InputError);
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

}  // namespace
}  // namespace underbody::postproc
