#include "postproc/views/views.h"

#include <algorithm>

#include "core/text.h"
#include "postproc/views/view_composer.h"

namespace underbody::postproc {

View drawn(const ComposedView& composed, const std::string& name) {
    View view;
    view.name = name;
    view.title = composed.scene.title;
    view.range = range_of(composed.scene);
    view.caption = composed.caption + " Colours: " + composed.scene.value_name + " from " +
                   core::format_number(view.range.first, 4) + " to " + core::format_number(view.range.second, 4) + " " +
                   composed.scene.value_unit + ".";
    view.png = draw_png(composed.scene);
    return view;
}

std::string range_key(const std::string& word) {
    return word == "speed" ? "velocity" : word == "shear" ? "wall_shear" : word;
}

void check_ranges(const ViewOptions& options, const std::vector<std::string>& shown) {
    for (const auto& [word, range] : options.ranges) {
        if (std::find(shown.begin(), shown.end(), word) == shown.end()) {
            throw core::UsageError("usage", "no picture asked for shows '" + word + "': its range means nothing", {},
                                   core::did_you_mean(word, shown));
        }
        if (!(range.first <= range.second)) {
            throw core::UsageError(
                "usage",
                "the range of '" + word + "' ends at " + core::format_number(range.second) + ", below where it begins",
                {}, "give LOW:HIGH");
        }
    }
}

std::vector<std::string> possible_views(const Field& field, const ViewOptions& options) {
    return ViewComposer(field, options).possible();
}

View view(const Field& field, const std::string& name, const ViewOptions& options, core::Progress& progress) {
    progress.check();
    return drawn(ViewComposer(field, options).compose(name), name);
}

std::vector<View> views(const Field& field, const ViewOptions& options, core::Progress& progress) {
    const ViewComposer composer(field, options);
    const auto names = composer.possible();
    if (names.empty()) {
        throw core::InputError("view",
                               "the field has no surface with a pressure to draw, nor a plane of cells with one",
                               {field.files.empty() ? "" : field.files.front(), {}, {}, {}});
    }
    std::vector<View> result;
    for (std::size_t i = 0; i < names.size(); ++i) {
        progress.check();
        progress.report(static_cast<double>(i) / static_cast<double>(names.size()), "drawing " + names[i]);
        result.push_back(drawn(composer.compose(names[i]), names[i]));
    }
    return result;
}

ViewOptions shared_view_options(const std::vector<const Field*>& fields, const ViewOptions& options,
                                core::Progress& progress) {
    ViewOptions shared = options;
    shared.ranges.clear();
    Box box = empty_box();
    for (const Field* field : fields) {
        ViewOptions own = options;
        own.ranges.clear();
        const ViewComposer composer(*field, own);
        widen(box, composer.whole_body());
        for (const auto& name : composer.possible()) {
            progress.check();
            const auto range = range_of(composer.compose(name).scene);
            if (!(range.first <= range.second)) {
                continue;  // nothing but missing values
            }
            const auto found = std::find_if(shared.ranges.begin(), shared.ranges.end(),
                                            [&](const auto& entry) { return entry.first == name; });
            if (found == shared.ranges.end()) {
                shared.ranges.emplace_back(name, range);
            } else {
                found->second = {std::min(found->second.first, range.first),
                                 std::max(found->second.second, range.second)};
            }
        }
    }
    if (!options.box && box[0] <= box[1]) {
        shared.box = box;
    }
    // What the caller fixed stays, for a view or for all of an array.
    std::erase_if(shared.ranges, [&](const auto& computed) {
        return std::any_of(options.ranges.begin(), options.ranges.end(), [&](const auto& given) {
            return given.first == computed.first || range_key(given.first) == array_of_view(computed.first);
        });
    });
    shared.ranges.insert(shared.ranges.end(), options.ranges.begin(), options.ranges.end());
    return shared;
}

}  // namespace underbody::postproc
