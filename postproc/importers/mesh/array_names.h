// What the arrays of one place - the nodes, the faces or the cells of a zone - are called: each name once, and the
// components of a vector joined to it. One rule for all formats.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "postproc/field/field.h"
#include "postproc/importers/mesh/buffer.h"

namespace underbody::postproc {

/// An array of a file, and what becomes of it.
struct ArrayPlan {
    std::string own;   ///< the file's name, without a unit
    std::string name;  ///< canonical, or the file's; "": it is left out
    int components = 1;
    int component = -1;  ///< once joined: it is this one of the vector `name`; -1: an array of its own
};

/// The canonical name of an array of one component that bears the name of a vector is that of the vector's size: CFX
/// and others write so.
CanonicalName named_as_scalar(CanonicalName canonical);

/// Gives every array a name of its own. A scalar "U" beside a scalar "V" is velocity_x. Of several of one meaning the
/// one with the plainest spelling has the canonical name, the others go by their own; a warning says so.
void settle_names(std::vector<ArrayPlan>& plans, const core::Place& place, core::Problems& problems);

/// Is an array asked for, by the file's name, its settled one or that of the vector it is a component of? The `phase`
/// (".phase-2") goes behind the settled ones.
bool is_wanted(const ReadOptions& options, const std::string& own, const std::string& name,
               const std::string& phase = {});

/// Joins components that make a whole vector: x, y and z; without z in a plane case (`dimension` 2). What the file does
/// not state is not nought: others stay as they are, and a warning says so if the vector was asked for.
void join_components(std::vector<ArrayPlan>& plans, int dimension, const ReadOptions& options, const core::Place& place,
                     core::Problems& problems);

/// x, y, z by turns, of `count` each; nullptr, or what is shorter, is 0.
Buffer<double> interleaved(const std::array<const Buffer<double>*, 3>& parts, std::size_t count);

/// Adds what has not been said yet.
void say_once(core::Problems& problems, core::Problem problem);

}  // namespace underbody::postproc
