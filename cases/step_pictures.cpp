// Pictures of the flow on the surface of chosen cases.
#include <nlohmann/json.hpp>

#include "cases/engine.h"
#include "core/text.h"
#include "postproc/field.h"
#include "postproc/loads.h"
#include "postproc/views.h"

namespace underbody::cases {

namespace {

postproc::ViewOptions view_options(const Study& study, const PictureSpec& spec, const Case& entry) {
    postproc::ViewOptions options;
    options.forward = postproc::axis_from(study.forward);
    options.up = postproc::axis_from(study.up);
    options.symmetry = study.symmetry;
    options.zones = entry.zones;
    options.case_name = entry.conditions.label();
    options.speed = entry.conditions.number("speed").value_or(0);
    if (spec.range) {
        options.ranges = {{"pressure", *spec.range}};
    }
    return options;
}

void draw_case(Engine& engine, const PictureSpec& spec, const Case& entry) {
    std::optional<postproc::Field> field;
    const auto read = [&]() -> const postproc::Field& {
        if (!field) {
            field = postproc::read_field(entry.file, {}, engine.progress);
        }
        return *field;
    };
    const postproc::ViewOptions options = view_options(engine.study, spec, entry);
    const auto names = spec.views.empty() ? postproc::possible_views(read(), options) : spec.views;
    for (const auto& name : names) {
        Key key("picture", {"postproc"});
        key.add(engine.hash_of(entry.file)).add(name).add(engine.study.forward).add(engine.study.up).add(engine.study.symmetry);
        key.add(entry.conditions).add(spec.range ? core::format_number(spec.range->first) + ":" + core::format_number(spec.range->second) : "");
        engine.picture("picture", spec.name + "/" + entry.name + "/" + name, key, [&] {
            const postproc::View view = postproc::view(read(), name, options, engine.progress);
            return nlohmann::json({{"title", view.title}, {"caption", spec.name + ": " + view.caption}}).dump() + "\n" + view.png;
        });
    }
}

}  // namespace

void run_pictures(Engine& engine) {
    if (!engine.options.pictures) {
        return;
    }
    for (const auto& spec : engine.study.pictures) {
        const auto chosen = engine.study.select(spec.where);
        if (chosen.empty()) {
            engine.fail("picture", spec.name, "no case fits its 'where'");
        }
        for (const Case* entry : chosen) {
            try {
                draw_case(engine, spec, *entry);
            } catch (const core::InputError& error) {
                engine.fail("picture", spec.name + "/" + entry->name, error.what());
            }
        }
    }
}

}  // namespace underbody::cases
