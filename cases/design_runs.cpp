// Runs of a design search: each planned design at each condition and fidelity, as cases of a sweep, and their loads.
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "cases/design.h"
#include "cases/design_file.h"
#include "cases/sweep.h"
#include "cases/sweep_parts.h"
#include "core/error.h"
#include "geometry/body/exact_body.h"
#include "postproc/field/field.h"
#include "postproc/loads/loads.h"
#include "postproc/loads/settled.h"
#include "postproc/loads/stated_loads.h"

namespace underbody::cases {

namespace fs = std::filesystem;
using tables::SearchVariable;

namespace {

/// The centre of buoyancy of the placed body, in the axes of its case.
geometry::Vec3 centre_of_buoyancy(const SweepCase& one) {
    const geometry::VolumeMoments m = geometry::ExactBody(geometry::read_shape(one.shape)).moments();
    geometry::Placement placement;
    placement.gap = one.conditions.number("gap").value_or(0);
    placement.pitch = one.conditions.number("pitch").value_or(0);
    return geometry::placed(geometry::Vec3{m.x / m.one, 0, m.z / m.one}, placement);
}

/// The loads of a solved case, SI, with what they scatter by.
void take_loads(const Study& study, const SweepCase& one, DesignRun& run, core::Progress& progress) {
    postproc::ReadOptions reading;
    reading.surfaces_only = true;
    const fs::path file = one.folder / solved_marker;
    const postproc::Field field = postproc::read_field(file, reading, progress);
    postproc::LoadsOptions options;
    options.forward = postproc::axis_from(study.forward);
    options.up = postproc::axis_from(study.up);
    options.symmetry = study.symmetry;
    options.reference = study.moments_about;
    options.references.density = study.reference.number("density");
    options.references.length = study.reference.number("length");
    options.references.width = study.reference.number("width");
    options.references.height = study.reference.number("height");
    options.references.speed = one.conditions.number("speed");  // the case's own, as its settings have it
    const postproc::LoadsResult result = postproc::loads(field, options, progress);
    core::Problems notes;
    const postproc::Settled settled = postproc::settled_by(result, postproc::stated_beside(file, result), file, notes);
    for (const auto& column : postproc::table_columns(result)) {
        run.loads[column.name] = column.value;
    }
    for (const auto& load : settled.loads) {
        run.sigmas[load.quantity] = load.sigma;
    }
    const geometry::Vec3 centre = centre_of_buoyancy(one);
    const double ahead = result.reference[0] - centre.x, above = result.reference[2] - centre.z;
    const auto all_of = [](const std::map<std::string, double>& values) {
        return values.contains("pitch_moment") && values.contains("lift_force") && values.contains("drag_force");
    };
    if (all_of(run.loads)) {
        run.loads[moment_at_buoyancy] =
            run.loads.at("pitch_moment") + ahead * run.loads.at("lift_force") + above * run.loads.at("drag_force");
    }
    if (all_of(run.sigmas)) {
        run.sigmas[moment_at_buoyancy] = std::hypot(run.sigmas.at("pitch_moment"), ahead * run.sigmas.at("lift_force"),
                                                    above * run.sigmas.at("drag_force"));
    }
    // A run that ended by its own criterion has settled by it; what it still drifts by is part of its sigmas.
    const auto marker = read_marker(file);
    const bool judged = marker.is_object() && marker.contains("settled") && marker["settled"].is_boolean();
    const bool unsettled =
        judged ? !marker["settled"].get<bool>() : settled.verdict == postproc::SettledVerdict::not_settled;
    run.state = unsettled ? not_settled_state : "solved";
}

/// What a fidelity's planned designs come to as a sweep.
SweepSpec sweep_of(const DesignSpec& spec, const FidelitySpec& fidelity, const std::vector<PlannedDesign>& plan,
                   const Study& study) {
    SweepSpec sweep;
    sweep.folder = fs::relative(spec.folder / "runs" / fidelity.name, study.folder()).string();
    for (const PlannedDesign& design : plan) {
        if (design.fidelity == fidelity.name && design.state == "planned") {
            sweep.bodies.push_back({design.name, spec.folder / "shapes" / (design.name + ".toml")});
        }
    }
    sweep.gaps = spec.gaps;
    sweep.pitches = spec.pitches;
    sweep.speeds = spec.speeds;
    sweep.jet = spec.jet;
    sweep.mesh = fidelity.mesh;
    sweep.kinematic_viscosity = spec.kinematic_viscosity;
    return sweep;
}

}  // namespace

void Design::solve(const Study& study, int jobs, core::Progress& progress) {
    const std::vector<SearchVariable> all = spec_.all_variables();
    if (write_shapes()) {  // of designs that were typed into plan.csv
        write_plan();
    }
    const auto can_be = [](const PlannedDesign& d) { return d.state == "planned"; };
    if (!plan_.empty() && std::none_of(plan_.cbegin(), plan_.cend(), can_be)) {
        throw core::InputError("empty",
                               "there is nothing to run: of " + std::to_string(plan_.size()) +
                                   " designs none can be. " + plan_.front().name + ": " + plan_.front().state,
                               {(spec_.folder / "plan.csv").string(), {}, {}, {}},
                               "other ranges in [[design.vary]] or limits in [design.volume], without this plan.csv");
    }
    for (const FidelitySpec& fidelity : spec_.fidelities) {
        Study with_sweep = study;
        with_sweep.sweep = sweep_of(spec_, fidelity, plan_, study);
        if (with_sweep.sweep->bodies.empty()) {
            continue;
        }
        const auto empty_run = [&](const SweepCase& one) {
            const std::string variant = one.shape.stem().string();
            const auto planned =
                std::find_if(plan_.begin(), plan_.end(), [&](const PlannedDesign& d) { return d.name == variant; });
            DesignRun run{variant, planned->at, fidelity.name, {}, {}, "", {}, ""};
            for (std::size_t v = spec_.variables.size(); v < all.size(); ++v) {
                run.at.push_back(one.conditions.number(all[v].name).value_or(0));
            }
            run.origin = origin_now(run.at, run.fidelity);
            return run;
        };
        const auto ended = [&](const SweepCase& one, const std::string& failure) {
            DesignRun run = empty_run(one);
            run.state = one_field(failure);
            if (failure.empty()) {
                try {
                    take_loads(study, one, run, progress);
                } catch (const core::Cancelled&) {
                    throw;
                } catch (const core::Error& error) {
                    run.state = one_field(error.message());
                }
            }
            keep(run);  // what was computed stays when the next case is interrupted
        };
        for (const SweepCase& one : sweep_cases(with_sweep, progress)) {
            const DesignRun* there = find(empty_run(one));
            if (one.present && (there == nullptr || !there->usable())) {
                ended(one, "");
            }
        }
        SweepOptions options;
        options.jobs = jobs;
        // A row without its case is of another solver, or of a search that was handed on without its fields.
        options.wanted = [&](const SweepCase& one) {
            const DesignRun* there = find(empty_run(one));
            return there == nullptr || !there->usable() || fs::exists(one.folder);
        };
        options.ended = ended;
        try {
            (void)sweep_locally(with_sweep, options, progress);
        } catch (...) {
            if (rows_changed_) {
                write_results();
            }
            throw;
        }
        if (rows_changed_) {
            write_results();
        }
    }
}

}  // namespace underbody::cases
