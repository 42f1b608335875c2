// The 3D view of a field's surfaces: VTK behind a widget. Only on the window's thread.
#pragma once

#include <QString>
#include <QWidget>
#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "postproc/field/field.h"

namespace underbody::studio {

/// Colours lie alike on both sides of zero: to the larger of the two ends.
[[nodiscard]] inline bool is_around_zero(const std::array<double, 2>& range) {
    return range[0] < 0 && range[1] > 0 && std::min(-range[0], range[1]) > 0.05 * std::max(-range[0], range[1]);
}

class Scene {
public:
    /// From where (x, y, z, m), at what (m), what is up, and half the height that is seen (m, without perspective).
    using Pose = std::array<double, 10>;

    explicit Scene(QWidget* parent);
    ~Scene();
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;

    [[nodiscard]] QWidget* widget() const;

    /// A field made ready for drawing: normals and, for half models, the mirrored side. Made in a job.
    struct Prepared;
    /// `mirror`: as LoadsOptions::symmetry ("y", "y=0.1"); empty: none. Safe from any thread.
    static std::shared_ptr<const Prepared> prepare(std::shared_ptr<const postproc::Field> field,
                                                   const std::string& mirror,
                                                   core::Progress& progress = core::Progress::none());

    /// Shows the surfaces of a field; keeps the camera unless `refit`.
    void show(std::shared_ptr<const Prepared> prepared, bool refit);
    [[nodiscard]] const postproc::Field* field() const;

    /// One tick a zone of the field.
    void set_visible(const std::vector<bool>& zones);
    [[nodiscard]] bool visible(std::size_t zone) const;

    /// An array that can colour the surface: one component, or the size of a vector.
    struct Choice {
        std::string name;    ///< "pressure", "wall_shear", ...
        int component = -1;  ///< -1: the size of a vector, or the only component
        std::string label;   ///< for people
        std::string unit;
    };
    [[nodiscard]] std::vector<Choice> choices() const;

    /// Of the visible zones; nothing where they have no such array. `whole_range` false: from the 1st to the 99th
    /// hundredth, so that single points at an edge do not take all the colours.
    [[nodiscard]] std::optional<std::array<double, 2>> range_of(const Choice& choice, bool whole_range) const;
    /// Colours the visible zones over the range; around zero with two colours when it holds both signs. An empty name:
    /// plain.
    void colour_by(const Choice& choice, std::array<double, 2> range);
    void show_edges(bool edges);
    /// Shows the mirrored side of half models where one was prepared.
    void mirror(bool on);
    /// Both are seen by one camera from now on.
    void share_camera(Scene& other);
    /// Light text on dark ground or the other way round.
    void set_ground(bool dark);
    /// "bottom", "top", "side", "front", "iso" in the frame of the file.
    void look_from(const std::string& view, const std::string& forward, const std::string& up,
                   const std::optional<std::array<double, 6>>& box = {});
    [[nodiscard]] Pose pose() const;
    /// In the projection of the last `look_from`.
    void set_pose(const Pose& pose);
    /// Another body as a line around it, in front of everything; nullptr: none. Only drawn, never picked or fitted to.
    /// True where it was another one before.
    bool outline(const std::shared_ptr<const Prepared>& other);
    /// Of what is drawn (x from, to, y, z), empty when that is nothing.
    [[nodiscard]] std::optional<std::array<double, 6>> bounds() const;

    /// What is under the mouse.
    struct Picked {
        std::string zone;
        std::array<double, 3> at{};  ///< m, file axes; of a mirrored side the place on the side that was read
        QString text;                ///< zone, place and value, for people
    };
    /// Called at a click (not at the end of a turn), and while the mouse rests or moves with no button held.
    std::function<void(const Picked&)> on_pick, on_hover;
    /// Called for a click with the right button.
    std::function<void(const Picked&)> on_menu;
    /// What is under a place of the widget, in its pixels; nothing beside the surfaces.
    [[nodiscard]] std::optional<Picked> pick(const QPoint& place) const;
    /// A dot at a place; empty: none.
    void mark(const std::optional<std::array<double, 3>>& at);
    /// Plain colours instead of an array: zones of the body and the others; empty: as they were.
    void tint(const std::vector<bool>& body);
    /// Called while the view is turned by hand, so that those with the same camera follow.
    std::function<void()> on_turn;
    /// Called once the hand that turned it, or its wheel, rests.
    std::function<void(const Pose&)> on_turned;
    /// A hand turns it, or has just done so and `on_turned` was not called yet.
    [[nodiscard]] bool in_hand() const;

    /// Of many faces a stand-in is turned; true while it is what is seen, until the picture of all of them is drawn.
    [[nodiscard]] bool stands_in() const;

    /// True from the first picture of everything on.
    [[nodiscard]] bool has_drawn() const;
    /// PNG bytes of what is seen.
    std::string png();
    /// In the next turn of the event loop, once for all who ask before it.
    void render();

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace underbody::studio
