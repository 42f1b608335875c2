// Compare: pictures in the place of surfaces: differences to the first, planes, streamlines.
#include <QComboBox>
#include <QLabel>
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/text.h"
#include "postproc/field/kinematic.h"
#include "postproc/loads/loads.h"
#include "postproc/probe/probe.h"
#include "postproc/views/views.h"
#include "studio/desktop/fields_panel.h"
#include "studio/desktop/fitted_picture.h"
#include "studio/desktop/qt_text.h"
#include "studio/figures/render.h"

namespace underbody::studio {

namespace {

struct Drawn {
    QImage image;
    QString said;  ///< the caption, or why there is no picture
};

QImage image_of(const std::string& png) {
    return QImage::fromData(reinterpret_cast<const uchar*>(png.data()), static_cast<int>(png.size()));
}

/// Each less the first, in one range of colours.
std::vector<Drawn> differences_to(const postproc::Field& first,
                                  const std::vector<std::shared_ptr<const postproc::Field>>& fields,
                                  const std::string& array, const postproc::ViewOptions& options,
                                  core::Progress& progress) {
    std::vector<const postproc::Field*> others;
    for (const auto& field : fields) {
        others.push_back(field.get());
    }
    std::vector<Drawn> drawn;
    for (const auto& one : postproc::difference_views(first, others, array, options, progress)) {
        drawn.push_back(one.view ? Drawn{image_of(one.view->png), qt(one.view->caption)} : Drawn{{}, qt(one.why)});
    }
    return drawn;
}

/// A file with its volume, as pictures need it.
struct ToDraw {
    std::filesystem::path file;
    postproc::ReadOptions reading;
    std::optional<double> density;
    postproc::ViewOptions options;
};

/// The speed over the gap's height, as `underbody views --view profile-gap` draws it.
Drawn gap_profile(const postproc::Field& field, const ToDraw& of, core::Progress& progress) {
    postproc::GapOptions gap;
    gap.forward = of.options.forward;
    gap.up = of.options.up;
    gap.symmetry = of.options.symmetry;
    gap.zones = of.options.zones;
    gap.density = of.density;
    core::Figure figure = postproc::gap_profile_figure(field, gap, progress);
    figure.title += ", " + of.options.case_name;
    return {image_of(render_png(figure, {of.options.width, of.options.height, 1})), qt(figure.caption)};
}

/// The same picture of each, in one range of colours and one box; a sentence where it is not possible.
std::vector<Drawn> views_of(const std::vector<ToDraw>& files, const std::string& name, core::Progress& progress) {
    std::vector<std::unique_ptr<postproc::Field>> fields;
    std::vector<const postproc::Field*> possible;
    std::vector<Drawn> drawn(files.size());
    for (std::size_t i = 0; i < files.size(); ++i) {
        fields.push_back(nullptr);
        try {
            auto field = postproc::read_field(files[i].file, files[i].reading, progress);
            (void)postproc::bring_to_pascal(field, files[i].density);
            if (name == "profile-gap") {
                drawn[i] = gap_profile(field, files[i], progress);
                continue;
            }
            const auto names = postproc::possible_views(field, files[i].options);
            if (std::find(names.begin(), names.end(), name) == names.end()) {
                QStringList allowed;
                for (const auto& one : names) {
                    allowed << qt(one);
                }
                drawn[i].said = "This file does not allow " + qt(name) + "; it allows " +
                                (allowed.isEmpty() ? QString("no picture") : allowed.join(", "));
                continue;
            }
            fields.back() = std::make_unique<postproc::Field>(std::move(field));
            possible.push_back(fields.back().get());
        } catch (const core::Cancelled&) {
            throw;
        } catch (const core::Error& error) {
            drawn[i].said = qt(error.message() + (error.hint().empty() ? "" : "; " + error.hint()));
        }
    }
    for (std::size_t i = 0; i < files.size(); ++i) {
        if (!fields[i]) {
            continue;
        }
        try {
            postproc::ViewOptions options = files[i].options;
            if (possible.size() > 1) {
                const auto shared = postproc::shared_view_options(possible, options, progress);
                options.box = shared.box;
                options.ranges = options.ranges.empty() ? shared.ranges : options.ranges;
            }
            const auto view = postproc::view(*fields[i], name, options, progress);
            drawn[i] = {image_of(view.png), qt(view.caption)};
        } catch (const core::Cancelled&) {
            throw;
        } catch (const core::Error& error) {
            drawn[i].said = qt(error.message());
        }
    }
    return drawn;
}

}  // namespace

/// Which cells show a picture or a sentence in the place of their surface, and which pictures are still to be drawn.
void FieldsPanel::show_pictures() {
    const std::string& view = state().fields.view;
    const bool views = view != "surface";
    std::vector<std::size_t> wanted;
    std::string key = view + "\n";
    const bool differences = !views && state().fields.difference && !cells_.empty() && cells_.front()->ready;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
        Cell& cell = *cells_[i];
        const bool as_picture = cell.ready && (views || (differences && i > 0));
        const bool failed = !cell.failed.isEmpty();
        const bool surface = !as_picture && !failed;
        cell.scene->widget()->setVisible(surface);
        cell.picture->setVisible(!surface);
        if (failed) {
            cell.picture->show_text(cell.failed);
        }
        const QString less = as_picture && !views ? QString("  less the first") : as_picture ? QString() : cell.empty;
        cell.title->setText(cell.source.title + (failed ? QString("   (not read)") : less + cell.mark()));
        key += cell.source.key() + "\n";
        if (as_picture) {
            wanted.push_back(i);
        }
    }
    std::string array = views ? view : std::string();
    for (const auto& choice :
         wanted.empty() || views ? std::vector<Scene::Choice>{} : cells_.front()->scene->choices()) {
        array = qt(choice.label) == array_->currentText() ? choice.name : array;
    }
    if (wanted.empty()) {
        pictures_of_.clear();
        jobs_.cancel("pictures");
        return;
    }
    for (const double end : state().fields.range.value_or(std::array<double, 2>{0, 0})) {
        key += core::format_number(end) + " ";
    }
    key += array + (state().fields.mirror.value_or(true) ? "" : " half") + "\nseen ";
    const bool turned_alone = pictures_of_.starts_with(key);  // the picture of before stays until the new one is there
    key += seen_from(state().fields);
    if (key == pictures_of_) {
        return;
    }
    pictures_of_ = key;
    for (const std::size_t i : turned_alone ? std::vector<std::size_t>() : wanted) {
        cells_[i]->picture->show_text(array.empty() ? "Choose what the difference is of: Colour by" : "…");
    }
    if (views) {
        draw_views(wanted, view);
    } else if (!array.empty()) {
        draw_differences(wanted, array);
    }
}

/// As large as they are shown, so that their words keep their size.
postproc::ViewOptions FieldsPanel::view_options(const Cell& cell) const {
    postproc::ViewOptions options;
    if (!session().folder.empty()) {
        options.forward = postproc::axis_from(session().study.forward);
        options.up = postproc::axis_from(session().study.up);
    }
    options.symmetry = state().fields.mirror.value_or(true) ? cell.source.symmetry : std::string();
    options.zones = cell.source.zones;
    const QSize room = cell.box->size() * devicePixelRatioF();
    options.width = std::max(480, room.width());
    options.height = std::max(320, room.height() - cell.title->height());
    options.text_size = std::clamp(560.0 / options.height, 1.0, 1.5);
    return options;
}

/// What a job drew goes to its cells, unless something else is wanted by then.
std::function<void()> FieldsPanel::shown_later(const std::vector<std::size_t>& cells, std::vector<QImage> images,
                                               std::vector<QString> said, const std::string& key) {
    return [this, cells, images = std::move(images), said = std::move(said), key] {
        for (std::size_t k = 0; k < cells.size() && key == pictures_of_; ++k) {
            FittedPicture& place = *cells_[cells[k]]->picture;
            if (images[k].isNull()) {
                place.show_text(said[k]);
            } else {
                place.show_image(images[k]);
            }
            place.setToolTip(said[k]);
        }
    };
}

namespace {

std::pair<std::vector<QImage>, std::vector<QString>> apart(const std::vector<Drawn>& drawn) {
    std::pair<std::vector<QImage>, std::vector<QString>> both;
    for (const auto& one : drawn) {
        both.first.push_back(one.image);
        both.second.push_back(one.said);
    }
    return both;
}

/// From where, and what is up; how near is left to the picture, which holds all of the body.
postproc::NamedCamera camera_of(const ViewPose& pose) {
    postproc::NamedCamera camera{};
    double length = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        camera.towards[i] = pose[3 + i] - pose[i];
        camera.up[i] = pose[6 + i];
        length += camera.towards[i] * camera.towards[i];
    }
    for (double& part : camera.towards) {
        part /= length > 0 ? std::sqrt(length) : 1;
    }
    return camera;
}

}  // namespace

/// All in one job, so that they have one range of colours.
void FieldsPanel::draw_differences(const std::vector<std::size_t>& cells, const std::string& array) {
    postproc::ViewOptions options = view_options(*cells_.front());
    options.camera = state().fields.camera;
    if (const auto& hand = state().fields.turned) {
        options.turned = camera_of(*hand);
    }
    if (const auto& range = state().fields.range) {
        options.ranges = {{"difference", {(*range)[0], (*range)[1]}}};
    }
    std::vector<std::shared_ptr<const postproc::Field>> fields;
    for (const std::size_t i : cells) {
        fields.push_back(cells_[i]->field);
    }
    jobs_.start("pictures", "differences of " + qt(array),
                [this, cells, fields, first = cells_.front()->field, array, options,
                 key = pictures_of_](core::Progress& progress) {
                    auto [images, said] = apart(differences_to(*first, fields, array, options, progress));
                    return shown_later(cells, images, said, key);
                });
}

void FieldsPanel::draw_views(const std::vector<std::size_t>& cells, const std::string& name) {
    std::vector<ToDraw> files;
    for (const std::size_t i : cells) {
        const Cell& cell = *cells_[i];
        ToDraw one{cell.source.file, cell.source.reading, cell.source.density, view_options(cell)};
        one.options.case_name = cell.source.title.toStdString();
        if (const auto& range = state().fields.range) {
            one.options.ranges = {{name, {(*range)[0], (*range)[1]}}};
        }
        for (const auto& entry : session().study.cases) {
            if ("case/" + entry.name == cell.source.id) {
                one.density = session().study.density_of(entry);
                one.options.speed = session().study.speed_of(entry).value_or(0);
            }
        }
        files.push_back(std::move(one));
    }
    jobs_.start("pictures", qt(name), [this, cells, files, name, key = pictures_of_](core::Progress& progress) {
        auto [images, said] = apart(views_of(files, name, progress));
        return shown_later(cells, images, said, key);
    });
}

std::size_t FieldsPanel::pictures() const {
    return static_cast<std::size_t>(std::count_if(cells_.begin(), cells_.end(), [](const auto& cell) {
        return cell->picture->isVisible() && !cell->picture->image.isNull();
    }));
}

QString FieldsPanel::said(std::size_t cell) const {
    return cell < cells_.size() ? cells_[cell]->picture->text() : QString();
}

}  // namespace underbody::studio
