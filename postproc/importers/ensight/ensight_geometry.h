// The parts of an EnSight Gold geometry: lists of elements, or structured blocks.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/progress.h"
#include "postproc/importers/ensight/ensight_input.h"
#include "postproc/importers/mesh/element_zone.h"

namespace underbody::postproc {

/// A run of elements of one kind within a part, in the order of the file. Ghosts are passed over.
struct EnsightRun {
    std::string kind;
    std::size_t first = 0;
    std::size_t count = 0;
    bool ghost = false;
};

struct EnsightPart {
    ElementPart elements;
    std::vector<EnsightRun> runs;
    bool block = false;              ///< structured
    std::size_t block_elements = 0;  ///< all of its cells, in the order of the file
    std::vector<std::size_t> kept;   ///< those that are neither blanked nor ghosts; empty: all
};

/// Reads a geometry of one step.
class EnsightGeometry {
public:
    /// `step` counts the steps within the file from 0; -1: the file has one step only. `most_nodes` bounds what the few
    /// numbers of a uniform block may ask for.
    EnsightGeometry(const std::filesystem::path& path, int step, std::uint64_t most_nodes, core::Progress& progress)
        : coding_(EnsightInput::coding_of(path)),
          in_(path, coding_, false),
          step_(step),
          most_nodes_(most_nodes),
          progress_(progress) {}

    void read();
    /// "3 parts: fluid, wall, ...", for messages.
    [[nodiscard]] std::string understood() const;

    std::string description;
    std::map<std::int64_t, EnsightPart> parts;
    [[nodiscard]] EnsightCoding coding() const { return coding_; }
    [[nodiscard]] bool swapped() const { return in_.swapped(); }

private:
    void part(std::int64_t number);
    void coordinates(EnsightPart& part, std::uint64_t nodes);
    void block(EnsightPart& part, const std::string& line);
    std::vector<std::int64_t> block_size(const std::string& line);
    void block_coordinates(EnsightPart& part, const std::string& line, const std::int64_t* size);
    void block_cells(EnsightPart& part, const std::int64_t* size, const std::vector<bool>& left_out);
    void elements(EnsightPart& part, const std::string& kind, unsigned char type, int corners, bool ghost);
    void polygons(EnsightPart& part, std::uint64_t count, bool ghost);
    void polyhedra(EnsightPart& part, std::uint64_t count, bool ghost);
    void check_nodes(std::vector<std::int64_t>& nodes, const ElementPart& part);
    [[nodiscard]] bool ends_here(const std::string& line);

    EnsightCoding coding_;
    EnsightInput in_;
    int step_;
    std::uint64_t most_nodes_;
    core::Progress& progress_;
    bool node_ids_ = false;
    bool element_ids_ = false;
    std::string pending_;  ///< a line that the part before did not want
};

}  // namespace underbody::postproc
