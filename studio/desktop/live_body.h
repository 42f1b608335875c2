// The body that follows its numbers: a coarse one while a slider moves, everything after it rests. Pure functions of
// the shape and of where it operates, so that a job can make them and a cache keep them.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "core/figure.h"
#include "core/progress.h"
#include "geometry/body/body_shape.h"
#include "geometry/body/certificate.h"
#include "geometry/body/mass_properties.h"
#include "geometry/water/added_mass.h"
#include "geometry/water/placement.h"
#include "studio/desktop/scene.h"
#include "studio/desktop/state/state.h"

namespace underbody::studio {

struct LiveBody {
    geometry::BodyShape shape;
    geometry::Placement placement;
    geometry::SurfaceMesh mesh;
    geometry::MassProperties mass;
    geometry::Clearance clearance;
    double base_area = 0;  ///< m^2
    core::Figure section;
    std::shared_ptr<const Scene::Prepared> drawn;
    /// Only of a whole one.
    std::optional<geometry::Certificate> certificate;
    std::optional<geometry::AddedMass> added_mass;
    std::string contact;  ///< why there is no added mass over the ground
};

/// About 1,500 triangles, mass, clearance, section: some 20 ms.
LiveBody moving_body(const geometry::BodyShape& shape, const geometry::Placement& placement,
                     core::Progress& progress = core::Progress::none());
/// About 20,000 triangles, and the certificate.
LiveBody resting_body(const geometry::BodyShape& shape, const geometry::Placement& placement,
                      core::Progress& progress = core::Progress::none());
/// Adds the added mass over the ground, by 600 panels extrapolated.
void add_added_mass(LiveBody& body, core::Progress& progress = core::Progress::none());

/// How far each number of a shape may go, the others as they are: where `check` lets it, at most twice itself or a
/// tenth of the length. Of the parts that are named ("body", "protrusion").
std::map<std::string, std::array<double, 2>> allowed_ranges(const geometry::BodyShape& shape,
                                                            const std::set<std::string>& parts,
                                                            core::Progress& progress = core::Progress::none());

}  // namespace underbody::studio
