// Compare: which files are shown, how they are read, and what is done with one that cannot be.
#include <QLabel>
#include <algorithm>

#include "cases/case_loads.h"
#include "core/error.h"
#include "core/text.h"
#include "postproc/field/import_error.h"
#include "postproc/field/unstated_units.h"
#include "postproc/loads/half_model.h"
#include "postproc/loads/loads.h"
#include "studio/desktop/compare_numbers.h"
#include "studio/desktop/fields_panel.h"
#include "studio/desktop/fitted_picture.h"
#include "studio/desktop/qt_text.h"
#include "studio/desktop/unit_sheet.h"

namespace underbody::studio {

namespace {

constexpr std::size_t most_cells = 6;

/// The case of the study that "case/ellipse-h5-p0" is; nullptr: none. There may be thousands.
const cases::Case* case_of(const cases::Study& study, std::string_view id) {
    if (!id.starts_with("case/")) {
        return nullptr;
    }
    const auto at = std::find_if(study.cases.begin(), study.cases.end(),
                                 [name = id.substr(5)](const cases::Case& one) { return one.name == name; });
    return at == study.cases.end() ? nullptr : &*at;
}

}  // namespace

std::string FieldsPanel::Source::key() const {
    std::string text = id + "\n" + reading.length_unit + "\n" + symmetry;
    for (const auto& [variable, unit] : reading.units) {
        text += "\n" + variable + "=" + unit;
    }
    for (const auto& zone : zones) {
        text += "\n" + zone;
    }
    text += "\n" + (density ? core::format_number(*density) : "");
    return text + "\n" + (reading.time ? core::format_number(*reading.time) : "");
}

FieldsPanel::Source FieldsPanel::source_of(const cases::Case& one) const {
    Source source{"case/" + one.name, one.file, one.zones, qt(one.name + ": " + one.conditions.label()), {}, {}, {}};
    source.reading = cases::read_options(one);
    source.symmetry = session().study.symmetry;
    return source;
}

FieldsPanel::Source FieldsPanel::source_of(const std::filesystem::path& file) const {
    Source source{"field/" + file.string(), file, {}, qt(file.filename().string()), {}, {}, {}};
    source.symmetry = session().study.symmetry;
    if (const auto said = state().readings.find(file.string()); said != state().readings.end()) {
        source.reading.length_unit = said->second.length_unit;
        source.reading.units.assign(said->second.units.begin(), said->second.units.end());
        source.zones = said->second.zones;
        source.density = said->second.density;
        const std::string& half = said->second.symmetry;
        source.symmetry = half == "none" ? "" : half.empty() ? source.symmetry : half;
    }
    return source;
}

QString FieldsPanel::title_by_difference(std::vector<Source>& sources) const {
    std::vector<const cases::Case*> known;
    for (const auto& source : sources) {
        known.push_back(case_of(session().study, source.id));
        if (known.back() == nullptr) {
            return {};  // a file from outside has no conditions
        }
    }
    if (known.size() < 2) {
        return {};
    }
    // Without the parts that all have, or with these alone.
    const auto part_of = [&](cases::Conditions conditions, bool shared) {
        const auto in_all = [&](const cases::Conditions& one) {
            return std::all_of(known.begin(), known.end(),
                               [&](const auto* other) { return other->conditions.satisfies(one); });
        };
        const cases::Conditions whole = conditions;
        const auto part = [&](auto member, const auto& value) {
            cases::Conditions one;
            one.own_units = whole.own_units;
            (one.*member).push_back(value);
            return in_all(one) != shared;
        };
        std::erase_if(conditions.numbers, [&](const auto& value) { return part(&cases::Conditions::numbers, value); });
        std::erase_if(conditions.texts, [&](const auto& value) { return part(&cases::Conditions::texts, value); });
        return qt(conditions.label());
    };
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const QString own = part_of(known[i]->conditions, false);
        sources[i].title = qt(known[i]->name) + (own.isEmpty() ? "" : ": " + own);
    }
    return part_of(known.front()->conditions, true);
}

std::vector<FieldsPanel::Source> FieldsPanel::wanted() const {
    std::vector<Source> sources;
    const auto add = [&](const std::string& id) {
        if (sources.size() == most_cells) {
            return;  // thousands may be chosen
        }
        if (id.starts_with("field/")) {
            sources.push_back(source_of(std::filesystem::path(id.substr(6))));
        }
        if (const auto* one = case_of(session().study, id)) {
            sources.push_back(source_of(*one));
        }
    };
    for (const auto& id : state().selection) {
        add(id);
    }
    if (const auto last = state().last.find("case"); sources.empty() && last != state().last.end()) {
        for (const auto& name : last->second) {
            add("case/" + name);
        }
    }
    if (sources.empty() && !session().study.cases.empty()) {
        // A picture from the start: the first case that the study itself wants pictures of, else the first of all.
        // (a damaged one has none to show).
        const cases::Case* chosen = &session().study.cases.front();
        for (const auto& loads : session().results.case_loads) {
            if (!loads.values.empty()) {
                chosen = &session().study.cases[loads.entry];
                break;
            }
        }
        for (const auto& picture : session().study.pictures) {
            if (const auto found = session().study.select(picture.where); !found.empty()) {
                chosen = found.front();
                break;
            }
        }
        sources.push_back(source_of(*chosen));
    }
    for (auto& source : sources) {
        source.reading.time = state().fields.time;
    }
    return sources;
}

QString FieldsPanel::said_of_choice() const { return choice_said_->text(); }

QString FieldsPanel::said_of_choice(const std::vector<Source>& sources) const {
    const auto& all = state().selection;
    const auto chosen = std::count_if(all.begin(), all.end(), [](const std::string& id) {
        return id.starts_with("case/") || id.starts_with("field/");
    });
    if (chosen > static_cast<std::ptrdiff_t>(sources.size())) {
        return QString("%1 of %2 chosen cases are shown: the first ones").arg(sources.size()).arg(chosen);
    }
    if (chosen > 0 || sources.empty()) {
        return {};
    }
    const auto last = state().last.find("case");
    return last != state().last.end() && !last->second.empty()
               ? QString("No case is chosen now: those that were chosen last are shown")
               : QString(
                     "No case is chosen: the first one is shown; choose up to six on the left (Ctrl+click adds one)");
}

namespace {

/// The loads of a field that was read, with their running integral; why there are none.
struct FieldLoads {
    std::shared_ptr<const postproc::LoadsResult> loads;
    std::string why;
};

FieldLoads sum_of(const postproc::Field& field, postproc::LoadsOptions options, core::Progress& progress) {
    options.stations = 80;
    try {
        return {std::make_shared<const postproc::LoadsResult>(postproc::loads(field, options, progress)), {}};
    } catch (const core::InputError& error) {
        return {nullptr, error.message() + (error.hint().empty() ? "" : "; " + error.hint())};
    } catch (const core::UsageError& error) {
        return {nullptr, error.message()};
    }
}

}  // namespace

postproc::LoadsOptions FieldsPanel::loads_options(const Source& source) const {
    if (const auto* one = case_of(session().study, source.id)) {
        return cases::loads_options(session().study, *one);
    }
    cases::Case outside;
    outside.file = source.file;
    outside.zones = source.zones;
    postproc::LoadsOptions options =
        session().folder.empty() ? postproc::LoadsOptions() : cases::loads_options(session().study, outside);
    options.zones = source.zones;
    options.symmetry = source.symmetry;
    options.references.density = source.density ? source.density : options.references.density;
    return options;
}

namespace {

/// By its symmetry boundary, else by the opening of its surface, of which the loads warn.
std::optional<postproc::LikelyHalf> half_of(const postproc::Field& field, const FieldLoads& sum) {
    auto half = postproc::likely_half(field);
    if (!half && sum.loads != nullptr && !sum.loads->cut_across.empty()) {
        half = postproc::LikelyHalf{sum.loads->cut_across, ""};
    }
    return half;
}

/// What a person is told of a file that cannot be read.
QString sentence_of(const core::Error& error) {
    return qt(error.place().text() + (error.place().text().empty() ? "" : ": ") + error.message() +
              (error.hint().empty() ? "" : "\n" + error.hint()));
}

}  // namespace

/// One that cannot be read says why in its cell, and the others go on.
void FieldsPanel::read(std::size_t index) {
    const Source source = cells_[index]->source;
    jobs_.start(
        QString("field %1").arg(index), "reading " + qt(source.file.filename().string()),
        [this, index, source, options = loads_options(source)](core::Progress& progress) -> std::function<void()> {
            const auto current = [this, index, key = source.key()] {
                return index < cells_.size() && cells_[index]->source.key() == key;
            };
            try {
                postproc::ReadOptions reading = source.reading;
                reading.surfaces_only = true;
                auto field =
                    std::make_shared<const postproc::Field>(postproc::read_field(source.file, reading, progress));
                const auto prepared = Scene::prepare(field, source.symmetry, progress);
                const auto sum = sum_of(*field, options, progress);
                const auto half = half_of(*field, sum);
                return [this, current, index, field, prepared, sum, half] {
                    if (current()) {
                        cells_[index]->half = half;
                        cells_[index]->loads = sum.loads;
                        cells_[index]->no_loads = sum.why;
                        taken(index, field, prepared);
                        warn_of_loads(index);
                    }
                };
            } catch (const core::Cancelled&) {
                throw;
            } catch (const postproc::UnitMissing& error) {
                const auto units = postproc::unstated_units(source.file, source.reading, progress);
                const QString text =
                    qt(error.place().text() + ": " + error.message()) + "\nUnits, half model … says it";
                return [this, current, index, units, text] {
                    if (current()) {
                        not_read(index, text);
                        unit_sheet().ask(cells_[index]->source.file, units);
                    }
                };
            } catch (const core::Error& error) {
                return [this, current, index, text = sentence_of(error), why = std::current_exception()] {
                    if (current()) {
                        not_read(index, text);
                        Q_EMIT desk_.refused("reading " + qt(cells_[index]->source.file.filename().string()), why);
                    }
                };
            }
        });
}

/// Of a file from outside; what is said of the loads of a case is said where the study is read.
void FieldsPanel::warn_of_loads(std::size_t index) {
    const Cell& cell = *cells_[index];
    if (cell.loads == nullptr || !cell.source.id.starts_with("field/")) {
        return;
    }
    for (core::Problem found : cell.loads->problems) {
        if (found.severity != core::Problem::Severity::warning) {
            continue;
        }
        QString said = qt(found.message);
        const QString across = qt(cell.loads->cut_across);
        const QString advice = qt("; " + postproc::half_model_advice(cell.loads->cut_across));
        if (!across.isEmpty() && said.contains(advice)) {  // first what is to be done
            said = "half of a model? then 'Half model across " + across + ": take it so': " + said.remove(advice);
        }
        found.message = said.toStdString();
        found.place.file = found.place.file.empty() ? cell.source.file.string() : found.place.file;
        Q_EMIT problem(found);
    }
}

void FieldsPanel::not_read(std::size_t index, const QString& why) {
    Cell& cell = *cells_[index];
    cell.ready = cell.reading = false;
    cell.field.reset();
    cell.failed = why;
    cell.no_loads = why.toStdString();
    show_numbers();
    recolour();
}

QString FieldsPanel::failed(std::size_t index) const {
    return index < cells_.size() ? cells_[index]->failed : QString();
}

UnitSheet& FieldsPanel::unit_sheet() {
    if (unit_sheet_ == nullptr) {
        unit_sheet_ = new UnitSheet(desk_, this);
    }
    return *unit_sheet_;
}

/// Of the files from outside that are shown, also where nothing is missing.
void FieldsPanel::ask_units() {
    for (const auto& cell : cells_) {
        if (!cell->source.id.starts_with("field/")) {
            continue;
        }
        const Source source = cell->source;
        jobs_.start("units of " + qt(source.id), "looking for units in " + qt(source.file.filename().string()),
                    [this, source](core::Progress& progress) {
                        postproc::ReadOptions bare;
                        const auto units = postproc::unstated_units(source.file, bare, progress);
                        return [this, source, units] { unit_sheet().ask(source.file, units); };
                    });
    }
}

}  // namespace underbody::studio
