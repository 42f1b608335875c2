// CGNS files that tests write through libcgns: a block, a cube, and what hangs on them.
#pragma once

#include <cgnslib.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace underbody::test {

/// An HDF5 file with one base at first. Every call of libcgns must succeed.
class CgnsWriter {
public:
    explicit CgnsWriter(const std::filesystem::path& path, int cell_dimension = 3, int physical_dimension = 3) {
        cg_set_file_type(CG_FILE_HDF5);
        ok(cg_open(path.c_str(), CG_MODE_WRITE, &file));
        cg_set_file_type(CG_FILE_NONE);
        add_base("Base", cell_dimension, physical_dimension);
    }
    ~CgnsWriter() { ok(cg_close(file)); }
    CgnsWriter(const CgnsWriter&) = delete;
    CgnsWriter& operator=(const CgnsWriter&) = delete;

    static void ok(int result) { EXPECT_EQ(result, CG_OK) << cg_get_error(); }

    void add_base(const std::string& name, int cell_dimension = 3, int physical_dimension = 3) {
        ok(cg_base_write(file, name.c_str(), cell_dimension, physical_dimension, &base));
        physical = physical_dimension;
    }
    /// A block of so many cells along each index, with edges of 1 (two of them: a plane one).
    int add_block(const std::string& name, const std::vector<cgsize_t>& cells) {
        std::vector<cgsize_t> size;
        for (const cgsize_t n : cells) {
            size.push_back(n + 1);
        }
        size.insert(size.end(), cells.begin(), cells.end());
        size.resize(3 * cells.size(), 0);
        ok(cg_zone_write(file, base, name.c_str(), size.data(), CGNS_ENUMV(Structured), &zone));
        std::array<std::vector<double>, 3> x;
        for (cgsize_t k = 0; k <= (cells.size() == 3 ? cells[2] : 0); ++k) {
            for (cgsize_t j = 0; j <= cells[1]; ++j) {
                for (cgsize_t i = 0; i <= cells[0]; ++i) {
                    x[0].push_back(i);
                    x[1].push_back(j);
                    x[2].push_back(k);
                }
            }
        }
        coordinates(x);
        return zone;
    }
    /// An unstructured zone with these nodes (none: room for eight), without sections.
    int add_zone(const std::string& name, const std::array<std::vector<double>, 3>& x, cgsize_t cells) {
        const cgsize_t size[3] = {static_cast<cgsize_t>(x[0].empty() ? 8 : x[0].size()), cells, 0};
        ok(cg_zone_write(file, base, name.c_str(), size, CGNS_ENUMV(Unstructured), &zone));
        next = 1;
        if (!x[0].empty()) {
            coordinates(x);
        }
        return zone;
    }
    /// A unit cube as element 1; the last node of its 8 is 1, 1, 1's neighbour 0, 1, 1.
    int add_cube(const std::string& name) {
        add_zone(name, cube_nodes(), 1);
        section("cells", CGNS_ENUMV(HEXA_8), {1, 2, 3, 4, 5, 6, 7, 8}, 8);
        return zone;
    }
    static std::array<std::vector<double>, 3> cube_nodes() {
        return {{{0, 1, 1, 0, 0, 1, 1, 0}, {0, 0, 1, 1, 0, 0, 1, 1}, {0, 0, 0, 0, 1, 1, 1, 1}}};
    }
    /// Its faces, outward: z = 0, z = 1, y = 0, x = 1, y = 1, x = 0.
    static std::vector<cgsize_t> cube_faces() {
        return {1, 4, 3, 2, 5, 6, 7, 8, 1, 2, 6, 5, 2, 3, 7, 6, 3, 4, 8, 7, 4, 1, 5, 8};
    }

    void coordinates(const std::array<std::vector<double>, 3>& x) {
        const char* names[] = {"CoordinateX", "CoordinateY", "CoordinateZ"};
        for (int k = 0; k < physical; ++k) {
            int index = 0;
            ok(cg_coord_write(file, base, zone, CGNS_ENUMV(RealDouble), names[k], x[static_cast<std::size_t>(k)].data(),
                              &index));
        }
    }
    /// Elements of one kind with so many nodes each, numbered on from those before.
    void section(const std::string& name, CGNS_ENUMT(ElementType_t) kind, const std::vector<cgsize_t>& nodes,
                 std::size_t each) {
        int index = 0;
        const auto last = next + static_cast<cgsize_t>(nodes.size() / each) - 1;
        ok(cg_section_write(file, base, zone, name.c_str(), kind, next, last, 0, nodes.data(), &index));
        next = last + 1;
    }
    int condition(const std::string& name, CGNS_ENUMT(BCType_t) type, CGNS_ENUMT(PointSetType_t) set,
                  CGNS_ENUMT(GridLocation_t) where, const std::vector<cgsize_t>& numbers, int indices = 1) {
        int index = 0;
        const auto points = static_cast<cgsize_t>(numbers.size() / static_cast<std::size_t>(indices));
        ok(cg_boco_write(file, base, zone, name.c_str(), type, set, points, numbers.data(), &index));
        if (where != CGNS_ENUMV(Vertex)) {
            ok(cg_boco_gridlocation_write(file, base, zone, index, where));
        }
        return index;
    }
    /// Its number.
    int solution(const std::string& name, CGNS_ENUMT(GridLocation_t) where, const std::string& variable,
                 const std::vector<double>& values) {
        int index = 0;
        int field = 0;
        ok(cg_sol_write(file, base, zone, name.c_str(), where, &index));
        ok(cg_field_write(file, base, zone, index, CGNS_ENUMV(RealDouble), variable.c_str(), values.data(), &field));
        return index;
    }

    int file = 0;
    int base = 0;
    int zone = 0;
    int physical = 3;
    cgsize_t next = 1;  ///< number of the next element of the zone
};

}  // namespace underbody::test
