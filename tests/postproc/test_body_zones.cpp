// Which walls are the body when nobody says: a ground, a tunnel, a ceiling, a room, several bodies.
#include <gmock/gmock.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <memory>

#include "core/random.h"
#include "postproc/loads/body_zones.h"

namespace underbody::postproc {
namespace {

using Point = std::array<double, 3>;
using testing::ElementsAre;
using testing::IsEmpty;

using Place = std::function<Point(double, double)>;

/// Quads over a grid of places.
vtkSmartPointer<vtkPolyData> quads(int columns, int rows, const Place& place) {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    vtkNew<vtkCellArray> cells;
    for (int j = 0; j <= rows; ++j) {
        for (int i = 0; i <= columns; ++i) {
            points->InsertNextPoint(place(double(i) / columns, double(j) / rows).data());
            const vtkIdType a = i + (columns + 1) * j;
            if (i < columns && j < rows) {
                cells->InsertNextCell({a, a + 1, a + columns + 2, a + columns + 1});
            }
        }
    }
    auto surface = vtkSmartPointer<vtkPolyData>::New();
    surface->SetPoints(points);
    surface->SetPolys(cells);
    return surface;
}

WallShape sheet(const std::string& name, int columns, int rows, const Place& place, bool known = true) {
    return shape_of(name, SurfaceArrays(*quads(columns, rows, place)), known);
}

/// Walls that keep their faces, so that one can look which of them meet; their sides are not known.
class Walls {
public:
    WallShape make(const std::string& name, int columns, int rows, const Place& place) {
        made_.push_back(std::make_unique<Made>(quads(columns, rows, place)));
        WallShape shape = shape_of(name, made_.back()->arrays, false);
        shape.surface = &made_.back()->arrays;
        return shape;
    }

private:
    struct Made {
        explicit Made(vtkSmartPointer<vtkPolyData> surface) : polygons(std::move(surface)), arrays(*polygons) {}
        vtkSmartPointer<vtkPolyData> polygons;
        SurfaceArrays arrays;
    };
    std::vector<std::unique_ptr<Made>> made_;
};

WallShape flat(const std::string& name, double x0, double x1, double y0, double y1, double z) {
    return sheet(name, 4, 4, [=](double s, double t) { return Point{x0 + s * (x1 - x0), y0 + t * (y1 - y0), z}; });
}

/// The part of an ellipsoid (semi-axes 1, 0.7, 0.5) above z = -0.35, normals outward; with y > 0 alone when `half`.
WallShape hull(bool half, double at = 0) {
    const double lowest = std::acos(-0.7);
    return sheet("hull", 60, 30, [=](double s, double t) {
        const double phi = (half ? M_PI : 2 * M_PI) * (1 - s);
        const double theta = 1e-6 + t * (lowest - 1e-6);
        return Point{at + std::sin(theta) * std::cos(phi), 0.7 * std::sin(theta) * std::sin(phi),
                     0.5 * std::cos(theta)};
    });
}

WallShape base(bool half) {
    const double radius = std::sin(std::acos(-0.7));
    return sheet("base", 60, 5, [=](double s, double t) {
        const double phi = (half ? M_PI : 2 * M_PI) * s;
        return Point{(1e-6 + radius * (1 - t)) * std::cos(phi), 0.7 * (1e-6 + radius * (1 - t)) * std::sin(phi), -0.35};
    });
}

/// A box of six walls as one zone, or its walls as six.
std::vector<WallShape> box(double size, bool inward) {
    std::vector<WallShape> walls;
    for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {-1.0, 1.0}) {
            const auto place = [=](double s, double t) {
                Point p{};
                const double u = (side > 0) != inward ? 2 * s - 1 : 1 - 2 * s;
                p[std::size_t(axis)] = size * side;
                p[std::size_t(axis + 1) % 3] = size * u;
                p[std::size_t(axis + 2) % 3] = size * (2 * t - 1);
                return p;
            };
            walls.push_back(sheet("wall-" + std::to_string(walls.size()), 3, 3, place));
        }
    }
    return walls;
}

std::vector<std::string> names_of(const std::vector<LeftOutZone>& walls) {
    std::vector<std::string> names;
    for (const auto& wall : walls) {
        names.push_back(wall.name);
    }
    return names;
}

TEST(BodyZones, ABodyAloneKeepsAllItsWalls) {
    ASSERT_GT(hull(false).volume, 0);
    for (const bool half : {false, true}) {
        EXPECT_THAT(walls_beside_body({hull(half), base(half)}), IsEmpty()) << half;
    }
    EXPECT_THAT(walls_beside_body(box(1, false)), IsEmpty());
    EXPECT_THAT(walls_beside_body({hull(false)}), IsEmpty());
}

TEST(BodyZones, AGroundIsNoneOfThem) {
    for (const bool half : {false, true}) {
        const double from = half ? 0 : -3;
        EXPECT_THAT(names_of(walls_beside_body({hull(half), flat("ground", -3, 3, from, 3, -0.4), base(half)})),
                    ElementsAre("ground"))
            << half;
        // In two parts, one of them just under the body, and uneven.
        const std::vector<WallShape> parts = {flat("near", -1, 1, half ? 0 : -0.7, 0.7, -0.4),
                                              flat("far", 1, 9, from, 3, -0.4), hull(half), base(half)};
        EXPECT_THAT(names_of(walls_beside_body(parts)), ElementsAre("near", "far")) << half;
        const auto bed = sheet("bed", 40, 40, [=](double s, double t) {
            return Point{6 * s - 3, from + t * (3 - from), -0.6 + 0.05 * std::sin(20 * s) * std::cos(17 * t)};
        });
        EXPECT_THAT(names_of(walls_beside_body({bed, hull(half), base(half)})), ElementsAre("bed")) << half;
    }
}

TEST(BodyZones, AThirdWallOnTheBodyTakesNothingFromIt) {
    for (const bool half : {false, true}) {
        const double from = half ? 0 : -3;
        const auto nozzle = sheet("protrusion", 8, 4, [=](double s, double t) {
            const double phi = (half ? M_PI : 2 * M_PI) * s;
            return Point{0.3 + 0.05 * std::cos(phi), 0.05 * std::sin(phi), -0.35 - 0.03 * t};
        });
        EXPECT_THAT(walls_beside_body({hull(half), base(half), nozzle}), IsEmpty()) << half;
        EXPECT_THAT(names_of(walls_beside_body({nozzle, flat("ground", -3, 3, from, 3, -0.4), base(half), hull(half)})),
                    ElementsAre("ground"))
            << half;
    }
    // A hull so flat that it looks one way as its base does: they meet at the rim.
    Walls made;
    const auto disc = [&](const std::string& name, double height) {
        return made.make(name, 40, 10, [=](double s, double t) {
            return Point{t * std::cos(2 * M_PI * s), t * std::sin(2 * M_PI * s), height * (1 - t * t)};
        });
    };
    const auto fin = made.make("fin", 4, 4, [](double s, double t) { return Point{0.1 * s, 0, 0.05 + 0.1 * t}; });
    EXPECT_THAT(walls_beside_body({disc("hull", 0.1), disc("base", 0), fin}), IsEmpty());
}

TEST(BodyZones, FloorAndCeilingOfAChannelAreNoneEither) {
    const std::vector<WallShape> walls = {flat("floor", -5, 5, -2, 2, -1), flat("ceiling", -5, 5, -2, 2, 1),
                                          hull(false), base(false)};
    EXPECT_THAT(names_of(walls_beside_body(walls)), ElementsAre("floor", "ceiling"));
}

TEST(BodyZones, ATunnelAroundTheBodyIsNoneWhenItsFluidIsInside) {
    const auto tunnel = [](bool known) {  // a tube along x, normals inward
        return sheet(
            "tunnel", 4, 40,
            [](double s, double t) {
                return Point{10 * s - 5, 3 * std::cos(2 * M_PI * t), 3 * std::sin(2 * M_PI * t)};
            },
            known);
    };
    ASSERT_LT(tunnel(true).volume, 0);
    EXPECT_THAT(names_of(walls_beside_body({tunnel(true), hull(false), base(false)})), ElementsAre("tunnel"));
    EXPECT_THAT(walls_beside_body({tunnel(false), hull(false), base(false)}),
                IsEmpty());  // nobody knows where its fluid is
}

TEST(BodyZones, ATunnelOfWhichNobodyKnowsTheSideIsKnownByWhatLiesInside) {
    Walls walls_made;
    const auto wall = [&](const std::string& name, int columns, int rows, const Place& place) {
        return walls_made.make(name, columns, rows, place);
    };
    const auto ball = [&](const std::string& name, double radius, double at) {
        return wall(name, 24, 12, [=](double s, double t) {
            return Point{at + radius * std::sin(M_PI * t) * std::cos(2 * M_PI * s),
                         radius * std::sin(M_PI * t) * std::sin(2 * M_PI * s), radius * std::cos(M_PI * t)};
        });
    };
    const auto tunnel = wall("tunnel", 40, 8, [](double s, double t) {
        return Point{10 * t - 5, 3 * std::cos(2 * M_PI * s), 3 * std::sin(2 * M_PI * s)};
    });
    EXPECT_THAT(names_of(walls_beside_body({tunnel, ball("body", 1, 0)})), ElementsAre("tunnel"));
    EXPECT_THAT(names_of(walls_beside_body({ball("body", 1, 0), ball("fin", 0.2, 2), tunnel})), ElementsAre("tunnel"));
    EXPECT_THAT(names_of(walls_beside_body({ball("tank", 3, 0), ball("body", 1, 0)})), ElementsAre("tank"));
    // A ring round the hub of a propeller has nothing inside but its own metal.
    const auto ring = wall("duct", 60, 24, [](double s, double t) {
        const double r = 2 + 0.3 * std::cos(2 * M_PI * t);
        return Point{0.8 * std::sin(2 * M_PI * t), r * std::cos(2 * M_PI * s), r * std::sin(2 * M_PI * s)};
    });
    EXPECT_THAT(walls_beside_body({ring, ball("hub", 0.5, 0)}), IsEmpty());
    // The base of a hull, drawn in behind its rim: it lies in the hollow, and touches.
    const double lowest = std::acos(-0.7);
    const auto hollow = wall("hull", 24, 12, [=](double s, double t) {
        return Point{std::sin(t * lowest) * std::cos(2 * M_PI * s), std::sin(t * lowest) * std::sin(2 * M_PI * s),
                     std::cos(t * lowest)};
    });
    const auto recess = wall("base", 24, 6, [=](double s, double t) {
        const double r = std::sin(lowest) * (1 - t);
        return Point{r * std::cos(2 * M_PI * s), r * std::sin(2 * M_PI * s), -0.7 + t};
    });
    EXPECT_THAT(walls_beside_body({hollow, recess}), IsEmpty());
}

TEST(BodyZones, WallsThatSurroundTheBodyTogetherAreNoneOfIt) {
    Walls made;
    // Faces of a block from `low` to `high`, normals outward or inward, each a zone of its own; some left away.
    const auto block = [&](const Point& low, const Point& high, const std::string& without, bool inward, bool known) {
        std::vector<WallShape> walls;
        for (int axis = 0; axis < 3; ++axis) {
            for (const bool upper : {false, true}) {
                const std::string name = std::string(upper ? "+" : "-") + "xyz"[axis];
                if (without.find(name) != std::string::npos) {
                    continue;
                }
                walls.push_back(made.make(name, 3, 3, [=](double s, double t) {
                    Point p{};
                    const auto a = std::size_t(axis), b = std::size_t(axis + 1) % 3, c = std::size_t(axis + 2) % 3;
                    const double u = upper != inward ? s : 1 - s;
                    p[a] = upper ? high[a] : low[a];
                    p[b] = low[b] + u * (high[b] - low[b]);
                    p[c] = low[c] + t * (high[c] - low[c]);
                    return p;
                }));
                walls.back().normals_into_fluid = known;
            }
        }
        return walls;
    };
    const auto body = [&](double from, bool known) {
        auto walls = block({-0.2, from, 0.1}, {0.2, 0.1, 0.2}, from == 0 ? "-y" : "", false, known);
        for (auto& wall : walls) {
            wall.name = "body" + wall.name;
        }
        return walls;
    };
    for (const bool known : {false, true}) {
        for (const char* open : {"-x+x", "", "+z", "-x+x+z"}) {  // a tunnel, a tank, a basin, a channel
            auto walls = body(-0.1, known);
            const auto around = block({-2, -1, 0}, {3, 1, 1.5}, open, true, known);
            walls.insert(walls.begin() + 3, around.begin(), around.end());
            const auto others = names_of(walls_beside_body(walls));
            EXPECT_EQ(others.size(), around.size()) << known << open;
            EXPECT_TRUE(
                std::none_of(others.begin(), others.end(), [](const auto& name) { return name.starts_with("body"); }))
                << known << open;
        }
        auto half = body(0, known);
        const auto around = block({-2, 0, 0}, {3, 1, 1.5}, "-y-x+x", true, known);
        half.insert(half.end(), around.begin(), around.end());
        EXPECT_THAT(names_of(walls_beside_body(half, true)), testing::UnorderedElementsAre("+y", "-z", "+z")) << known;
        // A small block under a large one lies between its sides, and in no hollow.
        auto two = block({-2, -1, 1}, {3, 1, 1.5}, "", false, known);
        const auto small = body(-0.1, known);
        two.insert(two.end(), small.begin(), small.end());
        const auto others = walls_beside_body(two);
        EXPECT_TRUE(std::none_of(others.begin(), others.end(), [](const auto& other) {
            return other.why.find("surrounds") != std::string::npos;
        })) << known;
    }
}

TEST(BodyZones, ARoomOrAChannelWithoutABodyKeepsItsWalls) {
    EXPECT_THAT(walls_beside_body(box(2, true)), IsEmpty());
    EXPECT_THAT(walls_beside_body({flat("floor", -5, 5, -2, 2, -1), flat("ceiling", -5, 5, -2, 2, 1)}), IsEmpty());
}

TEST(BodyZones, DoNotDependOnPlaceSizeOrDirection) {
    core::Random random(20261122);
    for (int trial = 0; trial < 20; ++trial) {
        const double scale = std::pow(10.0, 6 * random.uniform() - 3);
        const Point shift{1e3 * scale * random.uniform(), -1e3 * scale * random.uniform(), 5e2 * scale};
        const double angle = 2 * M_PI * random.uniform();
        const auto moved = [&](Point p) {
            return Point{shift[0] + scale * (std::cos(angle) * p[0] - std::sin(angle) * p[2]), shift[1] + scale * p[1],
                         shift[2] + scale * (std::sin(angle) * p[0] + std::cos(angle) * p[2])};
        };
        const double lowest = std::acos(-0.7);
        const std::vector<WallShape> walls = {
            sheet("hull", 60, 30,
                  [&](double s, double t) {
                      const double theta = t * lowest;
                      return moved({std::sin(theta) * std::cos(2 * M_PI * s),
                                    -0.7 * std::sin(theta) * std::sin(2 * M_PI * s), 0.5 * std::cos(theta)});
                  }),
            sheet("base", 60, 5,
                  [&](double s, double t) {
                      const double r = std::sin(lowest) * (1 - t);
                      return moved({r * std::cos(2 * M_PI * s), 0.7 * r * std::sin(2 * M_PI * s), -0.35});
                  }),
            sheet("ground", 3, 3, [&](double s, double t) {
                return moved({6 * s - 3, 6 * t - 3, -0.4});
            })};
        EXPECT_THAT(names_of(walls_beside_body(walls)), ElementsAre("ground")) << trial;
    }
}

TEST(BodyZones, ClosedBodiesThatLieApartAreNamed) {
    const auto ball = [](const std::string& name, double at) {
        return sheet(name, 40, 20, [=](double s, double t) {
            return Point{at + std::sin(M_PI * t) * std::cos(2 * M_PI * s), std::sin(M_PI * t) * std::sin(2 * M_PI * s),
                         std::cos(M_PI * t)};
        });
    };
    EXPECT_THAT(separate_bodies({ball("first", 0), ball("second", 3)}), ElementsAre("first", "second"));
    EXPECT_THAT(separate_bodies({ball("first", 0), hull(false, 3)}), IsEmpty());
    EXPECT_THAT(separate_bodies({ball("first", 0), ball("inner", 0.5)}), IsEmpty());
}

TEST(BodyZones, DuctsAreNoBodiesThoughTheirWallsCancel) {
    // A round pipe, open at both ends: its area vectors sum to nothing.
    const auto pipe = [](const std::string& name, double at) {
        return sheet(name, 40, 8, [=](double s, double t) {
            return Point{at + std::cos(2 * M_PI * s), std::sin(2 * M_PI * s), 5 * t};
        });
    };
    EXPECT_THAT(separate_bodies({pipe("inlet-duct", 0), pipe("outlet-duct", 3)}), IsEmpty());
    EXPECT_THAT(walls_beside_body({pipe("inlet-duct", 0), pipe("outlet-duct", 3)}), IsEmpty());
}

TEST(ZoneNames, SayWhatIsPlainlyNoWall) {
    const std::pair<const char*, ZoneKind> said[] = {
        {"inlet", ZoneKind::inlet},         {"Block 1/velocity-inlet-2", ZoneKind::inlet},
        {"INFLOW", ZoneKind::inlet},        {"pressure_outlet3", ZoneKind::outlet},
        {"opening", ZoneKind::outlet},      {"symmetryPlane", ZoneKind::symmetry},
        {"sym", ZoneKind::symmetry},        {"Symmetry top", ZoneKind::symmetry},
        {"farField", ZoneKind::farfield},   {"far_field", ZoneKind::farfield},
        {"FREESTREAM", ZoneKind::farfield}, {"cyclic1", ZoneKind::periodic}};
    for (const auto& [name, kind] : said) {
        EXPECT_EQ(kind_from_name(name), kind) << name;
    }
    for (const char* name : {"hull", "inlet-duct", "outlet flange", "opening_door", "interiors-panel", "asymmetry", "",
                             "7", "wall", "ground", "inlet/hull"}) {
        EXPECT_EQ(kind_from_name(name), ZoneKind::unknown) << name;
    }
}

TEST(ZoneNames, ChooseTheBodyOnlyWhereTheFileDoesNotSayWhatIsAWall) {
    const auto chosen = [](std::initializer_list<std::pair<const char*, ZoneKind>> zones,
                           std::vector<std::string>& otherwise) {
        Field field;
        for (const auto& [name, kind] : zones) {
            field.zones.emplace_back();
            field.zones.back().name = name;
            field.zones.back().kind = kind;
            field.zones.back().surface = vtkSmartPointer<vtkPolyData>::New();
        }
        const auto names_of = [](const std::vector<const Zone*>& some) {
            std::vector<std::string> names;
            std::transform(some.begin(), some.end(), std::back_inserter(names),
                           [](const Zone* zone) { return zone->name; });
            return names;
        };
        std::vector<const Zone*> excluded_by_kind;
        const auto names = names_of(possible_walls(field, excluded_by_kind));
        otherwise = names_of(excluded_by_kind);
        return names;
    };
    std::vector<std::string> otherwise;
    EXPECT_THAT(chosen({{"hull", ZoneKind::unknown}, {"inlet", ZoneKind::unknown}, {"a", ZoneKind::outlet}}, otherwise),
                ElementsAre("hull"));
    EXPECT_THAT(otherwise, ElementsAre("inlet", "a"));
    EXPECT_THAT(chosen({{"hull", ZoneKind::unknown}, {"inlet", ZoneKind::wall}}, otherwise), ElementsAre("inlet"));
    EXPECT_THAT(otherwise, IsEmpty());
    EXPECT_THAT(chosen({{"inlet", ZoneKind::unknown}, {"outlet", ZoneKind::unknown}}, otherwise),
                ElementsAre("inlet", "outlet"));
    EXPECT_THAT(otherwise, IsEmpty());
}

}  // namespace
}  // namespace underbody::postproc
