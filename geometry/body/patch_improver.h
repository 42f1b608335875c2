// Flips edges and moves inner points of a patch so that its triangles in space get rounder.
#pragma once

#include "geometry/body/patch_mesher.h"

namespace underbody::geometry {

/// Keeps the points and segments of the problem and the labels' regions; the smallest angle around a point never falls.
void improve_patch(PatchTriangles& patch, const PatchProblem& problem);

}  // namespace underbody::geometry
