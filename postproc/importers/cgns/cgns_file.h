// CGNS files behind a door: none of libcgns's headers in ours, what a zone holds comes out as plain structs. Sizes are
// checked against the file before memory is taken, lengths and values come in SI by the units that the file states.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/units.h"
#include "postproc/field/field.h"
#include "postproc/importers/mesh/buffer.h"
#include "postproc/importers/mesh/element_zone.h"

namespace underbody::postproc {

struct CgnsZone {
    int index = 1;  ///< from 1
    std::string name;
    bool structured = false;
    std::array<std::int64_t, 3> nodes = {1, 1, 1};  ///< along each index; unstructured: in the first
    std::array<std::int64_t, 3> cells = {1, 1, 1};

    [[nodiscard]] double all_cells() const {
        return static_cast<double>(cells[0]) * static_cast<double>(cells[1]) * static_cast<double>(cells[2]);
    }
};

/// The elements of an unstructured zone that carry the numbers `first` to `last`.
struct CgnsSection {
    struct Element {
        unsigned char type = 0;  ///< VTK's
        std::size_t first = 0;   ///< of its corners in `nodes`
        std::size_t count = 0;
        [[nodiscard]] int dimension() const;  ///< 0 a vertex, 1 a line, 2 a face, 3 a cell
    };
    std::string name;
    std::int64_t first = 1;
    std::int64_t last = 0;
    bool polygons = false;   ///< NGON
    bool polyhedra = false;  ///< NFACE
    std::vector<Element> elements;
    std::vector<std::int64_t> nodes;  ///< from 0; NFACE: signed element numbers of faces
};

/// A boundary condition, with the faces or the vertices that it names.
struct CgnsCondition {
    enum class Where { nowhere, vertices, faces };
    int index = 1;  ///< from 1
    std::string name;
    std::string type;  ///< "BCWall", of its family where it leaves it to that
    ZoneKind kind = ZoneKind::unknown;
    Where where = Where::nowhere;
    int normal = -1;                    ///< structured: the index across its faces, 0 to 2; -1: the file does not say
    bool range = false;                 ///< `numbers` are the first and the last of what it names, for all between
    int indices = 1;                    ///< numbers for each face or vertex; structured: one in each direction
    std::vector<std::int64_t> numbers;  ///< from 1: elements or nodes
    int data_sets = 0;                  ///< values of its own (BCDataSet)

    /// How many faces or vertices it names.
    [[nodiscard]] double named() const;
};

/// A variable that a boundary condition holds for itself, SI.
struct CgnsBoundaryValues {
    std::string variable;                      ///< the file's name
    bool at_faces = false;                     ///< the file says so; else at the condition's faces or vertices
    Buffer<double> values;                     ///< one for all, or one each of what the condition names, in its order
    std::optional<CgnsCondition> places = {};  ///< names other faces or vertices than the condition: of these
};

/// A file opened for reading, one base of it at one step in time. Every failure is an InputError with file and zone.
class CgnsFile {
public:
    /// The base and step of `time` [s]; without it the last base, or the latest of those that state times, and its last
    /// step. A time that the file does not state is refused.
    explicit CgnsFile(const std::filesystem::path& path, std::optional<double> time = {}, const std::string& base = {});
    ~CgnsFile();
    CgnsFile(const CgnsFile&) = delete;
    CgnsFile& operator=(const CgnsFile&) = delete;

    /// Of the library that wrote the file, where it is later than the one here; 0 otherwise.
    [[nodiscard]] float newer_version() const { return version_; }
    /// The names of all bases; empty where there is one, or where each is a step in time.
    [[nodiscard]] std::vector<std::string> other_bases() const;
    [[nodiscard]] int bases() const { return bases_; }
    [[nodiscard]] const std::string& base_name() const { return base_name_; }
    [[nodiscard]] int cell_dimension() const { return cell_dimension_; }
    [[nodiscard]] int physical_dimension() const { return physical_dimension_; }
    /// The numbers of the zones that are there at the step, from 1.
    [[nodiscard]] const std::vector<int>& zones() const { return zones_; }
    [[nodiscard]] CgnsZone zone(int index) const;

    /// Three coordinates a node of the grid at the step, in m; those that the space does not have are 0. `length_unit`
    /// is theirs where the file states none, unless empty.
    [[nodiscard]] Buffer<double> points(const CgnsZone& zone, const std::string& length_unit = {});
    /// In order of their element numbers; structured zones have none.
    [[nodiscard]] std::vector<CgnsSection> sections(const CgnsZone& zone, core::Progress& progress) const;
    [[nodiscard]] std::vector<CgnsCondition> conditions(const CgnsZone& zone) const;
    /// Values of a condition's own; `unread` takes the names of those that are none of the field's variables on its
    /// faces or vertices.
    [[nodiscard]] std::vector<CgnsBoundaryValues> boundary_values(const CgnsZone& zone, const CgnsCondition& condition,
                                                                  const ReadOptions& options,
                                                                  std::vector<std::string>& unread);
    /// Times of the steps of all bases, s; empty when the file states none.
    [[nodiscard]] const std::vector<double>& times() const { return times_; }
    /// That of the step, where the file states it.
    [[nodiscard]] std::optional<double> time() const { return time_; }
    /// Solutions at vertices and cells, only the arrays asked for: those of the step where the zone says which these
    /// are, else the last that holds a variable. `left` counts the solutions of other steps.
    [[nodiscard]] std::vector<PartValues> solutions(const CgnsZone& zone, const ReadOptions& options,
                                                    core::Progress& progress, int& left);
    /// What to tell of all that was read so far.
    [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

    /// m per unit of length of the base.
    [[nodiscard]] double base_length() const { return of_base_.length; }
    /// So far, at any node that was read.
    [[nodiscard]] bool units_stated() const { return units_stated_; }
    /// The file's words for values without dimensions -> the variables read so far of which it says so.
    [[nodiscard]] const std::map<std::string, std::set<std::string>>& without_dimensions() const {
        return without_dimensions_;
    }
    /// Variables that were not SI -> what 1 of the file's units is.
    [[nodiscard]] const std::map<std::string, std::string>& converted() const { return converted_; }

    [[noreturn]] void fail(const CgnsZone& zone, const std::string& what) const {
        fail("zone '" + zone.name + "': " + what);
    }

private:
    /// What makes SI of the file's units (CGNS knows no time but the second).
    struct Scales {
        double mass = 1;
        double length = 1;
        core::Conversion temperature;
        std::string data_class;  ///< "" where none is stated
        [[nodiscard]] core::Conversion to_si(std::string_view unit) const;
    };
    bool open_newer(bool hdf5);
    [[noreturn]] void fail(const std::string& what) const;
    void ok(const CgnsZone& zone, int result, const char* what) const;
    void check_room(const CgnsZone& zone, double count) const;
    /// Labels and numbers of the nodes from the base down to one.
    using Path = std::vector<std::pair<const char*, int>>;
    [[nodiscard]] bool go_to(const Path& path) const;
    Scales scales_at(const Scales& above, const Path& path);
    void read_units_of_base();
    core::Conversion to_si(const Path& array, const std::string& variable, const std::string& unit);
    [[nodiscard]] std::optional<CgnsCondition> places_of_values(const CgnsZone& zone,
                                                                const CgnsCondition& condition) const;
    void read_boundary_values(const CgnsZone& zone, const Path& data, bool neumann, bool at_faces,
                              const ReadOptions& options, std::vector<CgnsBoundaryValues>& result,
                              std::vector<std::string>& unread);
    struct Steps {
        int count = 0;
        std::vector<double> times;  ///< s; as many, or none
    };
    struct Choice;
    void warn(const std::string& what);
    [[noreturn]] void refuse_time(const std::string& why) const;
    [[nodiscard]] Steps steps_of_base(int base) const;
    [[nodiscard]] std::vector<std::string> base_names() const;
    [[nodiscard]] int base_called(const std::string& base) const;
    void choose_step(std::optional<double> time, const std::string& base);
    void find_zones_of_step();
    static bool names_something(std::string_view pointer);
    [[nodiscard]] std::vector<std::string> names_by_step(std::string_view array) const;
    [[nodiscard]] std::vector<std::vector<std::string>> pointers(const CgnsZone& zone,
                                                                 const std::vector<std::string_view>& arrays) const;
    [[nodiscard]] int grid_of_step(const CgnsZone& zone);
    void read_nodes(const CgnsZone& zone, int array, Buffer<double>& column) const;
    static void choose(std::vector<Choice>& choices, Choice&& found);
    void tell_of_unsaid_times(const CgnsZone& zone, const std::vector<Choice>& choices, bool says);
    [[nodiscard]] std::vector<Choice> choices(const CgnsZone& zone, const ReadOptions& options, int& left);
    [[nodiscard]] CgnsCondition condition(const CgnsZone& zone, int index) const;
    [[nodiscard]] CgnsSection section(const CgnsZone& zone, int index) const;
    [[nodiscard]] int family_type(const CgnsZone& zone, int condition) const;

    std::string name_;
    float version_ = 0;
    std::uint64_t bytes_ = 0;
    std::uint64_t most_values_ = 0;
    int file_ = -1;
    int bases_ = 0;
    bool base_per_step_ = false;
    int base_ = 1;
    std::string base_name_;
    std::vector<int> zones_;
    bool zones_by_step_ = false;  ///< the file says which zones are there at a step
    int cell_dimension_ = 3;
    int physical_dimension_ = 3;
    std::vector<double> times_;
    std::optional<double> time_;
    bool time_asked_ = false;
    std::size_t steps_ = 0;  ///< of the base
    std::size_t step_ = 0;   ///< of these
    std::vector<std::string> warnings_;
    Scales of_base_;
    bool units_stated_ = false;
    std::map<std::string, std::string> converted_;
    std::map<std::string, std::set<std::string>> without_dimensions_;
};

}  // namespace underbody::postproc
