// What a field holds, in numbers: for `info`, lists and tables.
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "postproc/field/field.h"

namespace underbody::postproc {

struct ZoneSummary {
    std::string name;
    int id = 0;
    std::string kind;           ///< "wall", "fluid", ...
    std::string original_kind;  ///< the file's word
    std::size_t points = 0;
    std::size_t faces = 0;          ///< polygons, or line segments of a line
    std::size_t cells = 0;          ///< of a volume
    std::array<double, 3> lower{};  ///< bounding box, m; zeros without points
    std::array<double, 3> upper{};
};

/// One array over all zones that have it.
struct ArraySummary {
    std::string name;
    std::string unit;
    std::string on;  ///< "nodes", "faces", "cells"; "nodes, faces" when zones differ
    int components = 1;
    std::vector<std::string> component_names;  ///< of a tensor: XX, YY, ZZ, XY, YZ, XZ
    double min = 0;                            ///< of the size for vectors; missing values left out
    double max = 0;
    std::size_t missing = 0;
    std::vector<std::string> zones;
    std::string original_name;
    std::string original_unit;
};

struct FieldSummary {
    std::string file;
    std::string format;
    std::string writer;
    int dimension = 3;
    std::size_t points = 0;
    std::size_t faces = 0;
    std::size_t cells = 0;
    std::vector<ZoneSummary> zones;
    std::vector<ArraySummary> arrays;
    std::string pressure_reference;  ///< "gauge", "absolute", "unknown"
    double operating_pressure = 0;
    std::vector<std::pair<std::string, std::string>> metadata;
    core::Problems problems;
};

FieldSummary summarise(const Field& field);

/// Keys of docs/conventions.md section 7.
void to_json(nlohmann::json& json, const FieldSummary& summary);

}  // namespace underbody::postproc
