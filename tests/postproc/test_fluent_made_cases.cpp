// Plane cases that the test writes itself, in text and in both binary codings: cells and faces split by adaption
// (sections 58 and 59), faces cut at a non-conformal interface (61), overset boundaries; zones in pieces out of order.
#include <gmock/gmock.h>
#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/file.h"
#include "import_support.h"

namespace underbody {
namespace {

using Numbers = std::vector<std::uint32_t>;

enum class Coding { text, single_precision, double_precision };

/// A plane case in one of the codings.
class CaseFile {
public:
    CaseFile(Coding coding, std::uint32_t cells, std::uint32_t faces, const std::vector<std::array<double, 2>>& nodes)
        : coding_(coding) {
        out_ << std::hex << "(0 \"made by a test\")\n(2 2)\n(4 (60 0 0 1 2 4 4 4 8 8 8 4))\n(10 (0 1 " << nodes.size()
             << " 0 2))\n(12 (0 1 " << cells << " 0))\n(13 (0 1 " << faces << " 0))\n";
        out_ << "(" << index(10) << " (1 1 " << nodes.size() << " 1 2)(";
        for (const auto& [x, y] : nodes) {
            real(x);
            real(y);
        }
        end(10);
        add_line("(37 ((rp-3d? #f) (case-file-units \"si\")))");
    }
    void add_line(const std::string& line) { out_ << line << "\n"; }
    /// `numbers` in hexadecimal, or as they lie in memory.
    void add(int section, const std::string& header, const Numbers& numbers) {
        out_ << "(" << index(section) << " (" << header << ")(";
        for (const std::uint32_t number : numbers) {
            if (coding_ == Coding::text) {
                out_ << " " << number;
            } else {
                raw(&number, 4);
            }
        }
        end(section);
    }
    [[nodiscard]] std::filesystem::path written(const core::TemporaryFolder& folder) const {
        core::write_file(folder.path() / "made.cas", out_.str());
        return folder.path() / "made.cas";
    }

private:
    [[nodiscard]] std::string index(int section) const {
        return (coding_ == Coding::text               ? ""
                : coding_ == Coding::single_precision ? "20"
                                                      : "30") +
               std::to_string(section);
    }
    void raw(const void* bytes, std::size_t count) {
        out_.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(count));
    }
    void real(double x) {
        const auto single = static_cast<float>(x);
        if (coding_ == Coding::text) {
            out_ << " " << x;
        } else if (coding_ == Coding::single_precision) {
            raw(&single, 4);
        } else {
            raw(&x, 8);
        }
    }
    void end(int section) {
        out_ << (coding_ == Coding::text ? "))\n" : ")\nEnd of Binary Section   " + index(section) + ")\n");
    }

    Coding coding_;
    std::ostringstream out_;
};

/// A square beside another one that was split into four. The parents' faces lie in zones of their own: one the file
/// calls hidden (kind 1f), one a wall that only the tree tells from its children.
CaseFile adapted(Coding coding) {
    CaseFile file(coding, 6, 19,
                  {{0, 0}, {1, 0}, {2, 0}, {0, 1}, {1, 1}, {2, 1}, {1, 0.5}, {1.5, 0}, {2, 0.5}, {1.5, 1}, {1.5, 0.5}});
    file.add_line("(12 (2 1 5 1 3))\n(12 (3 6 6 20 3))");
    file.add(13, "4 1 6 2 2", {2, 7, 1, 2, 7, 5, 1, 5, 8, 11, 2, 3, 11, 10, 5, 4, 7, 11, 5, 2, 11, 9, 4, 3});
    file.add(13, "5 7 f 3 2", {1, 2, 1, 0,  2, 8, 2,  0, 8, 3, 3, 0, 3, 9, 3, 0, 9, 6,
                               4, 0, 6, 10, 4, 0, 10, 5, 5, 0, 5, 4, 1, 0, 4, 1, 1, 0});
    file.add(13, "6 10 10 1f 2", {2, 5, 1, 6});
    file.add(13, "5 11 13 3 2", {2, 3, 6, 0, 3, 6, 6, 0, 6, 5, 6, 0});
    file.add(58, "6 6 3 2", {4, 2, 3, 4, 5});
    file.add(59, "10 13 6 4", {2, 1, 2, 2, 8, 9, 2, 10, 11, 2, 12, 13});
    file.add_line(
        "(39 (2 fluid water 1)())\n(39 (3 fluid parents 1)())\n(39 (4 interior inside 1)())\n(39 (5 wall rim 1)())");
    return file;
}

/// A square beside two half squares; the zones of the interface do not share nodes, the faces cut out of them do the
/// fluxes. `kind`: of the zones beside the interface.
CaseFile interface_case(Coding coding, const std::string& kind, bool with_children, bool rim_in_pieces = false) {
    CaseFile file(coding, 3, with_children ? 13 : 11,
                  {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {1, 0}, {2, 0}, {2, 0.5}, {2, 1}, {1, 1}, {1, 0.5}});
    file.add_line("(12 (2 1 3 1 3))");
    file.add(13, "3 1 1 2 2", {10, 7, 3, 2});
    const Numbers rim = {1, 2, 1, 0, 5, 6, 2, 0, 6, 7, 2, 0, 7, 8, 3, 0, 8, 9, 3, 0, 3, 4, 1, 0, 4, 1, 1, 0};
    if (rim_in_pieces) {
        file.add(13, "5 5 8 3 2", Numbers(rim.begin() + 12, rim.end()));
        file.add(13, "5 2 4 3 2", Numbers(rim.begin(), rim.begin() + 12));
    } else {
        file.add(13, "5 2 8 3 2", rim);
    }
    file.add(13, "6 9 9 " + kind + " 2", {2, 3, 1, 0});
    file.add(13, "7 a b " + kind + " 2", {10, 5, 2, 0, 9, 10, 3, 0});
    if (with_children) {
        file.add(13, "4 c d 2 2", {5, 10, 1, 2, 10, 9, 1, 3});
        file.add(61, "c d", {9, 10, 9, 11});
    }
    file.add_line("(39 (2 fluid water 1)())\n(39 (3 interior inside 1)())\n(39 (5 wall rim 1)())");
    return file;
}

constexpr Coding codings[] = {Coding::text, Coding::single_precision, Coding::double_precision};

TEST(FluentTrees, OfAnAdaptedMeshTheChildrenAreTheMesh) {
    for (const Coding coding : codings) {
        const core::TemporaryFolder folder;
        const auto field = postproc::read_field(adapted(coding).written(folder));
        EXPECT_EQ(test::cells_of(field), 5);
        const auto* water = field.find("water");
        ASSERT_NE(water, nullptr);
        EXPECT_NEAR(test::volume_of(*water->volume), 2, 1e-12);
        EXPECT_NEAR(test::smallest_volume(*water->volume), 0.25, 1e-12);
        EXPECT_EQ(test::count_cells(*water->volume, VTK_QUAD), 4);
        EXPECT_EQ(test::count_cells(*water->volume, VTK_POLYGON), 1);  // the square with the hanging node
        // The rim once round, not twice where its parents lie on it.
        const auto* rim = field.find("rim");
        ASSERT_NE(rim, nullptr);
        EXPECT_EQ(rim->surface->GetNumberOfCells(), 9);
        EXPECT_NEAR(test::area_of(*rim->surface), 6, 1e-12);
        for (const auto& problem : field.problems) {
            EXPECT_EQ(problem.message.find("closed"), std::string::npos) << problem.message;
        }
    }
}

TEST(FluentTrees, CutAnywhereAreRefusedOrWhole) {
    for (const Coding coding : codings) {
        const core::TemporaryFolder folder;
        const std::string whole = core::read_file(adapted(coding).written(folder));
        const auto first = whole.rfind(coding == Coding::text               ? "(58"
                                       : coding == Coding::single_precision ? "(2058"
                                                                            : "(3058");
        for (std::size_t size = first + 1; size < whole.rfind("))") + 2; ++size) {
            core::write_file(folder.path() / "cut.cas", whole.substr(0, size));
            const std::string reason = test::refusal(folder.path() / "cut.cas");
            EXPECT_TRUE(reason.empty() || reason.find("understood so far") != std::string::npos)
                << size << " " << reason;
        }
        // A tree that announces more parents than the file has bytes.
        std::string wrong = whole;
        wrong.replace(wrong.find(" (6 6 3 2)"), 10, " (6 ffffff6 3 2)");
        core::write_file(folder.path() / "wrong.cas", wrong);
        EXPECT_NE(test::refusal(folder.path() / "wrong.cas"), "");
    }
}

TEST(FluentTrees, AtANonConformalInterfaceCellsEndAtTheFacesTheMeshWasMadeWith) {
    for (const Coding coding : codings) {
        const core::TemporaryFolder folder;
        const auto field = postproc::read_field(interface_case(coding, "18", true).written(folder));
        EXPECT_EQ(test::cells_of(field), 3);
        const auto* water = field.find("water");
        ASSERT_NE(water, nullptr);
        EXPECT_NEAR(test::volume_of(*water->volume), 2, 1e-12);
        EXPECT_NEAR(test::smallest_volume(*water->volume), 0.5, 1e-12);
        EXPECT_EQ(test::count_cells(*water->volume, VTK_QUAD), 3);
        EXPECT_NEAR(test::area_of(*field.find("rim")->surface), 6, 1e-12);
    }
}

/// Pressure and velocity on the rim's faces 2 to 8, in the pieces given: the pressure is the face's number, y-velocity
/// ten times that, x-velocity 0.
std::string data_in(const std::vector<std::pair<int, int>>& pieces) {
    std::ostringstream out;
    out << "(0 \"made by a test\")\n(33 (3 11 10))\n";
    for (const auto& [variable, factor] : {std::pair{1, 1}, {111, 0}, {112, 10}}) {
        for (const auto& [first, last] : pieces) {
            out << "(300 (" << variable << " 5 1 0 1 " << first << " " << last << ")\n(";
            for (int id = first; id <= last; ++id) {
                out << factor * id << "\n";
            }
            out << "))\n";
        }
    }
    return out.str();
}

/// The number of the rim's face, by where its middle lies.
int number_at(const std::array<double, 2>& middle) {
    const std::vector<std::array<double, 2>> middles = {{0.5, 0}, {1.5, 0}, {2, 0.25}, {2, 0.75},
                                                        {1.5, 1}, {0.5, 1}, {0, 0.5}};
    for (std::size_t i = 0; i < middles.size(); ++i) {
        if (std::hypot(middles[i][0] - middle[0], middles[i][1] - middle[1]) < 1e-6) {
            return static_cast<int>(i) + 2;
        }
    }
    return 0;
}

TEST(FluentBlocks, ValuesFindTheirFacesWhateverTheOrderOfThePieces) {
    for (const Coding coding : codings) {
        for (const bool in_pieces : {false, true}) {
            for (const auto& pieces : std::vector<std::vector<std::pair<int, int>>>{
                     {{2, 8}}, {{2, 4}, {5, 8}}, {{5, 8}, {2, 4}}, {{5, 6}, {2, 3}}}) {
                if (in_pieces && pieces.size() == 1) {
                    continue;  // data over two pieces of a zone are those of another case
                }
                const core::TemporaryFolder folder;
                const auto path = interface_case(coding, "18", false, in_pieces).written(folder);
                core::write_file(folder.path() / "made.dat", data_in(pieces));
                const auto field = postproc::read_field(path);
                const auto* rim = field.find("rim");
                ASSERT_NE(rim, nullptr);
                auto* pressure = rim->surface->GetCellData()->GetArray("pressure");
                auto* velocity = rim->surface->GetCellData()->GetArray("velocity");
                ASSERT_NE(pressure, nullptr) << (field.problems.empty() ? "" : field.problems.back().message);
                ASSERT_NE(velocity, nullptr);
                EXPECT_EQ(velocity->GetNumberOfComponents(), 3);
                ASSERT_EQ(pressure->GetNumberOfTuples(), 7);
                const bool whole = pieces.back() != std::pair{2, 3};
                for (vtkIdType c = 0; c < 7; ++c) {
                    std::array<double, 6> box{};
                    rim->surface->GetCell(c)->GetBounds(box.data());
                    const int number = number_at({0.5 * (box[0] + box[1]), 0.5 * (box[2] + box[3])});
                    ASSERT_NE(number, 0);
                    const bool given = whole || number == 2 || number == 3 || number == 5 || number == 6;
                    if (given) {
                        EXPECT_EQ(pressure->GetComponent(c, 0), number);
                        EXPECT_EQ(velocity->GetComponent(c, 1), 10 * number);
                        EXPECT_EQ(velocity->GetComponent(c, 0), 0);
                    } else {
                        EXPECT_TRUE(std::isnan(pressure->GetComponent(c, 0)));
                    }
                }
                const bool told = std::any_of(field.problems.begin(), field.problems.end(), [](const auto& problem) {
                    return problem.message.find("SV_P covers 4 of the 7 faces of zone rim") != std::string::npos;
                });
                EXPECT_EQ(told, !whole);
            }
        }
    }
}

TEST(FluentTrees, OverlappingMeshesKeepTheirEdgesAsInterfacesThatCarryNoLoad) {
    for (const Coding coding : codings) {
        const core::TemporaryFolder folder;
        const auto field = postproc::read_field(interface_case(coding, "19", false).written(folder));
        EXPECT_EQ(test::cells_of(field), 3);
        int overset = 0;
        for (const auto& zone : field.zones) {
            overset += zone.original_kind == "overset" ? 1 : 0;
            EXPECT_EQ(zone.kind == postproc::ZoneKind::interface, zone.original_kind == "overset") << zone.name;
        }
        EXPECT_EQ(overset, 2);
    }
}

}  // namespace
}  // namespace underbody
