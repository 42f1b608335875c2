// Explore, Compare, kinds of stability maps and themes in the real window, without a display.
// First, because Qt makes `signals` a keyword and the dynamics room has a member of that name.
// clang-format off
#include "surrogates/dynamics/basin/region.h"
// clang-format on

#include <qcustomplot.h>

#include <QCheckBox>
#include <QComboBox>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QMouseEvent>
#include <QPushButton>
#include <QSignalSpy>
#include <QTabBar>
#include <QTableView>
#include <QTableWidget>
#include <QTest>
#include <QXmlStreamReader>
#include <nlohmann/json.hpp>

#include "cases/case_loads.h"
#include "core/table.h"
#include "core/text.h"
#include "geometry/body/body_report.h"
#include "studio/desktop/case_pictures.h"
#include "studio/desktop/compare_numbers.h"
#include "studio/desktop/compare_sheet.h"
#include "studio/desktop/design_panel.h"
#include "studio/desktop/explore_panel.h"
#include "studio/desktop/fields_panel.h"
#include "studio/desktop/force_panel.h"
#include "studio/desktop/parallel_view.h"
#include "studio/desktop/pictures_panel.h"
#include "studio/desktop/plot_view.h"
#include "studio/desktop/problems_panel.h"
#include "studio/desktop/region_panel.h"
#include "studio/desktop/state/exports.h"
#include "studio/desktop/study_tree.h"
#include "studio/desktop/theme.h"
#include "tests/studio/desktop/window_fixture.h"

namespace underbody::studio {
namespace {

// Another kind of rows has other columns: what is kept of the one says nothing of the other.
TEST_F(Window, ShapesThatVaryAreMadeBrushedAndTakenIntoDesign) {
    open(computed_study());
    act("workspace explore");
    act("vary body.base_cut=0.6:0.8:3");
    settle(*window_);
    auto& explore = panel<ExplorePanel>();
    ASSERT_TRUE(explore.shapes());
    ASSERT_EQ(explore.rows().rows(), 3U);
    geometry::BodyOptions options;
    options.set = {{"body.base_cut", "0.7"}};
    options.panels = 0;
    const auto body = geometry::read_body(computed_study() / "shapes" / "ellipse.toml", options);
    const double volume = explore.rows().numbers("volume")[1];
    EXPECT_NEAR(volume, body.mass.volume, 1e-12) << "the numbers of the library";
    act("brush volume=" + core::format_number(0.999 * volume) + ":" + core::format_number(1.001 * volume));
    EXPECT_EQ(explore.kept(), (std::vector<std::size_t>{1}));
    act("rows cases");
    EXPECT_EQ(explore.kept().size(), 5U);
    act("rows shapes");
    EXPECT_EQ(explore.kept().size(), 1U);
    for (auto* table : explore.findChildren<QTableView*>()) {
        table->selectRow(0);
    }
    for (auto* button : explore.findChildren<QPushButton*>()) {
        if (button->text().contains("Design")) {
            EXPECT_TRUE(button->isEnabled());
            button->click();
        }
    }
    EXPECT_EQ(window_->desk().state().workspace, "design");
    EXPECT_EQ(window_->desk().state().design.changes.at("ellipse").at("body.base_cut"), "0.7");
    window_->desk().undo();
    window_->desk().undo();
    EXPECT_TRUE(window_->desk().state().design.changes.empty());
}

// Names of shapes are long and differ at their ends: they took all the room of the table.
TEST_F(Window, NumbersOfShapesThatVaryAreSeenBesideTheirNames) {
    const fs::path study = copy_of_study();
    std::string text = core::read_file(study / "study.toml");
    const std::string name = "ellipse of the first campaign with a rounded protrusion of 2 mm";
    text.replace(text.find("name = \"ellipse\""), 16, "name = \"" + name + "\"");
    core::write_file(study / "study.toml", text);
    open(study);
    act("workspace explore");
    act("shape '" + name + "'");
    act("workspace explore");
    act("vary body.base_cut=0.6:0.8:3");
    settle(*window_);
    auto& explore = panel<ExplorePanel>();
    ASSERT_EQ(explore.rows().rows(), 3U);
    auto* table = explore.findChild<QTableView*>();
    EXPECT_LT(table->columnWidth(0), table->viewport()->width() / 2);
    EXPECT_EQ(table->textElideMode(), Qt::ElideMiddle) << "the number behind the name stays";
    act("axes body.base_cut centroid_z");
    settle(*window_);
    QStringList labels;
    for (auto* plot : explore.findChildren<QCustomPlot*>()) {
        labels << plot->xAxis->label() << plot->yAxis->label();
    }
    EXPECT_TRUE(labels.contains("body base cut")) << labels.join("; ").toStdString();
    EXPECT_TRUE(labels.contains("centroid z (mm)")) << labels.join("; ").toStdString();
}

// The whole tree was read anew for a star beside one name: undo of a number took 5 ms for it.
TEST_F(Window, AChangedShapeIsMarkedInItsPlace) {
    open(computed_study());
    auto* tree = window_->findChild<StudyTree*>();
    ASSERT_NE(tree, nullptr);
    const auto shown = [&] {
        const QModelIndex shapes = tree->model()->index(0, 0);
        return tree->model()->index(0, 0, shapes).data().toString().toStdString();
    };
    const std::string before = shown();
    QSignalSpy read(tree->model(), &QAbstractItemModel::modelReset);
    act("workspace design");
    act("set 'body.height=140 mm'");
    EXPECT_EQ(shown(), before + " *");
    window_->desk().undo();
    EXPECT_EQ(shown(), before);
    EXPECT_EQ(read.count(), 0);
}

// Points of 1 to 20 mm stood over "2.5 5 7.5 10 12.5 1517.520".
TEST_F(Window, AShortLogarithmicAxisHasRoundNumbers) {
    PlotView view(nullptr);
    view.resize(500, 400);
    core::Figure figure;
    figure.x = {"gap", "mm", 0, 0, true};
    figure.y = {"lift_force", "N", 0, 0, false};
    core::FigureCurve curve;
    curve.name = "ellipse_front-h3-p0";
    curve.x = {1, 2, 3, 5, 10, 20};
    curve.y = {6, 4, 3, 3, 3, 3.5};
    figure.curves.push_back(curve);
    view.show_figure(figure);
    view.show();
    settle(*window_);
    auto* plot = view.findChild<QCustomPlot*>();
    ASSERT_NE(plot, nullptr);
    plot->replot();
    EXPECT_EQ(QStringList(plot->xAxis->tickVectorLabels().toList()).join(' '), "1 2 5 10 20");
    EXPECT_EQ(plot->yAxis->label(), "lift force (N)");
}

TEST_F(Window, ARangeIsTypedAsWellAsDragged) {
    open(computed_study());
    act("workspace explore");
    settle(*window_);
    auto& explore = panel<ExplorePanel>();
    QLineEdit* kept = nullptr;
    for (auto* edit : explore.findChildren<QLineEdit*>()) {
        kept = edit->accessibleName() == "Ranges that are kept" ? edit : kept;
    }
    ASSERT_NE(kept, nullptr);
    kept->setFocus();
    QTest::keyClicks(kept, "gap=2.5mm:10mm");
    QTest::keyClick(kept, Qt::Key_Return);
    EXPECT_EQ(explore.kept().size(), 3U);
    EXPECT_DOUBLE_EQ(window_->desk().state().explore.brush.at("gap")[0], 0.0025);
    kept->selectAll();
    QTest::keyClicks(kept, "gap=10mm:2.5mm");
    QTest::keyClick(kept, Qt::Key_Return);
    EXPECT_NE(window_->last_error().indexOf("is empty"), -1) << window_->last_error().toStdString();
    EXPECT_EQ(explore.kept().size(), 3U) << "and nothing changed";
    kept->selectAll();
    QTest::keyClicks(kept, "gap=2.5mm:10mm pitch=-1deg:1deg");  // as the log has them
    QTest::keyClick(kept, Qt::Key_Return);
    EXPECT_EQ(window_->desk().state().explore.brush.size(), 2U) << window_->last_error().toStdString();
}

TEST_F(Window, PicturesOfTheKeptCasesStandBesideEachOther) {
    const fs::path folder = copy_of_study();
    core::write_file(folder / "study.toml", core::read_file(folder / "study.toml") +
                                                "\n[[picture]]\nname = \"narrow\"\nwhere = { gap = \"2mm\" }\n"
                                                "views = [\"pressure-underbody\", \"pressure-hull\"]\n[[picture]]\n"
                                                "name = \"all\"\nwhere = { pitch = 0 }\n"
                                                "views = [\"pressure-underbody\"]\n");
    const auto run = test::run_underbody({"study", "run", folder.string()});
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    open(folder);
    act("workspace explore");
    act("show pictures");
    settle(*window_);
    auto& pictures = panel<CasePictures>();
    ASSERT_EQ(pictures.views()->count(), 2);
    act("show pictures pressure-hull");
    settle(*window_);
    EXPECT_EQ(pictures.list()->count(), 1);
    EXPECT_EQ(pictures.said(), "1 picture; 4 cases without this picture");
    act("show pictures pressure-underbody");
    settle(*window_);
    ASSERT_EQ(pictures.list()->count(), 5);
    std::set<qint64> different;
    for (int i = 0; i < 5; ++i) {
        const QImage icon = pictures.list()->item(i)->icon().pixmap(200, 150).toImage();
        ASSERT_FALSE(icon.isNull()) << i;
        different.insert(
            qHash(QByteArray(reinterpret_cast<const char*>(icon.constBits()), static_cast<int>(icon.sizeInBytes()))));
    }
    EXPECT_EQ(different.size(), 5U) << "each case its own";
    act("brush gap=2.5mm:10mm");
    settle(*window_);
    EXPECT_EQ(pictures.list()->count(), 3) << "those that the brush keeps";
    auto& lines = panel<ParallelView>();
    EXPECT_FALSE(lines.pointed_out());
    auto* place = pictures.list()->viewport();
    const QPoint on = pictures.list()->visualItemRect(pictures.list()->item(1)).center();
    QMouseEvent move(QEvent::MouseMove, on, place->mapToGlobal(on), Qt::NoButton, Qt::NoButton, Qt::NoModifier);
    QApplication::sendEvent(place, &move);
    ASSERT_TRUE(lines.pointed_out()) << "the line of the picture under the mouse";
    EXPECT_EQ(*lines.pointed_out(), panel<ExplorePanel>().kept().at(1));
    QEvent leave(QEvent::Leave);
    QApplication::sendEvent(place, &leave);
    EXPECT_FALSE(lines.pointed_out());
    pictures.list()->setCurrentRow(1);
    ASSERT_EQ(window_->desk().state().selected("case").size(), 1U);
    EXPECT_EQ(window_->desk().state().selected("case").front(), pictures.list()->item(1)->text().toStdString());
    // What is exported is what is seen, not the points that are hidden.
    const auto exported = [&](const std::string& name) {
        panel<ExplorePanel>().export_picture(folder_.path() / name);
        return QImage(QString::fromStdString((folder_.path() / name).string()));
    };
    act("cells explore table pictures");
    settle(*window_);
    EXPECT_EQ(exported("pictures.png").text("Title"), "pressure-underbody");
    act("cells explore lines");
    settle(*window_);
    EXPECT_TRUE(panel<ExplorePanel>().has_picture());
    EXPECT_EQ(exported("lines.png").text("Title"), "3 of 5 cases");
    act("cells explore table points");
    settle(*window_);
    EXPECT_TRUE(exported("points.png").text("Title").isEmpty()) << "a figure";
    act("cells explore table");
    settle(*window_);
    EXPECT_FALSE(panel<ExplorePanel>().has_picture());
    act("cells explore lines table points pictures");
    settle(*window_);
    act("show pictures pressure-underbdy");
    EXPECT_NE(window_->last_error().indexOf("pressure-underbody"), -1) << window_->last_error().toStdString();
    act("show points");
    settle(*window_);
    EXPECT_FALSE(pictures.isVisible());
    window_->desk().undo();
    settle(*window_);
}

// Forces of the library, with the errors of the study's tables; what differs by more than twice the joint one is bold.
TEST_F(Window, ComparesForcesByZoneAndAlongTheBody) {
    const fs::path folder = copy_of_study();
    std::string text = core::read_file(folder / "study.toml");
    text.insert(text.find("net_weight"), "relative_sigma = 0.01\n");
    core::write_file(folder / "study.toml", text);
    open(folder);
    std::vector<ComparedCase> cases;
    for (const auto& one : window_->desk().session().study.cases) {
        postproc::LoadsOptions options = cases::loads_options(window_->desk().session().study, one);
        options.stations = 40;
        if (one.name == "ellipse-h5-p0" || one.name == "ellipse-h2-p0") {
            postproc::ReadOptions reading;
            reading.surfaces_only = true;
            cases.push_back({"case/" + one.name,
                             one.name,
                             std::make_shared<const postproc::LoadsResult>(
                                 postproc::loads(postproc::read_field(one.file, reading), options)),
                             {}});
        }
    }
    ASSERT_EQ(cases.size(), 2U);
    CompareNumbers numbers(window_->desk(), nullptr);
    numbers.show_cases(cases, false);
    const double first = cases[0].loads->named.lift_force, second = cases[1].loads->named.lift_force;
    const auto shown = [](double value, int digits) {
        return QString::fromStdString(core::format_number(value, digits)).replace('-', QChar(0x2212));
    };
    EXPECT_EQ(numbers.forces()->item(0, 0)->text(), shown(first, 4));
    EXPECT_EQ(numbers.forces()->item(1, 1)->text(), shown(0.01 * std::abs(second), 2));
    EXPECT_EQ(numbers.forces()->item(1, 2)->text(), shown(second - first, 3));
    EXPECT_EQ(numbers.forces()->item(1, 2)->font().bold(),
              std::abs(second - first) > 2 * std::hypot(0.01 * first, 0.01 * second));
    const auto sum = [&](int row) {
        double all = 0;
        for (int column = 0; column + 4 < numbers.zones()->columnCount(); column += 4) {
            all += numbers.zones()->item(row, column)->text().replace(QChar(0x2212), '-').toDouble();
        }
        return all;
    };
    EXPECT_NEAR(sum(0), first, 2e-3);
    const int all = numbers.zones()->columnCount() - 4;  // differences of each zone, whatever the cells show
    EXPECT_EQ(numbers.zones()->item(0, all + 1)->text(), "–");
    EXPECT_EQ(numbers.zones()->item(1, all + 1)->text(), shown(second - first, 3));
    EXPECT_FALSE(numbers.zones()->isColumnHidden(1));
    EXPECT_TRUE(numbers.along()->has_figure());
    EXPECT_NEAR(cases[0].loads->stations.back().behind.lift_force, first, 1e-9);
    const core::Table table = numbers.table();
    EXPECT_EQ(table.rows(), 2U);
    EXPECT_DOUBLE_EQ(table.numbers("lift_force_sigma")[0], 0.01 * std::abs(table.numbers("lift_force")[0]));
}

TEST_F(Window, ASheetIsWrittenWithItsCasesRangeAndUnits) {
    Sheet sheet;
    sheet.title = "pressure (Pa), -120 to 110";
    sheet.about = "a study & its camera <below>";
    for (int i = 0; i < 3; ++i) {
        QImage image(300, 200, QImage::Format_RGB32);
        image.fill(Qt::blue);
        sheet.cells.emplace_back(QString("case %1").arg(i), image);
    }
    sheet.rows = {{"", "lift (N)"}, {"case 0", "0.123"}};
    for (const char* ending : {".png", ".pdf", ".svg"}) {
        write_sheet(sheet, folder_.path() / ("sheet" + std::string(ending)));
    }
    const QImage png(QString::fromStdString((folder_.path() / "sheet.png").string()));
    EXPECT_EQ(png.text("Title"), sheet.title);
    EXPECT_EQ(core::read_file(folder_.path() / "sheet.pdf").substr(0, 5), "%PDF-");
    QXmlStreamReader svg(QByteArray::fromStdString(core::read_file(folder_.path() / "sheet.svg")));
    int images = 0;
    QString words;
    while (!svg.atEnd()) {
        svg.readNext();
        images += svg.isStartElement() && svg.name() == "image" ? 1 : 0;
        words += svg.isCharacters() ? svg.text().toString() + "|" : QString();
    }
    EXPECT_FALSE(svg.hasError()) << svg.errorString().toStdString();
    EXPECT_EQ(images, 3);
    for (const char* word : {"pressure (Pa), -120 to 110", "a study & its camera <below>", "case 2", "0.123"}) {
        EXPECT_TRUE(words.contains(word)) << word << " in " << words.toStdString();
    }
    EXPECT_THROW(write_sheet(sheet, folder_.path() / "sheet.gif"), core::UsageError);
}

// Titles that repeat what all cases have took up to three lines each, so that bodies under one camera had several
// sizes; a difference that is bold in the window was not on the sheet; the tabs went away from under the mouse.
TEST_F(Window, CasesAreTitledByWhatTellsThemApart) {
    open(computed_study());
    act("select case/ellipse-h5-p0 case/ellipse-h2-p0");
    act("workspace compare");
    settle(*window_);
    const auto titled = [&] {
        QStringList titles;
        for (auto* label : panel<FieldsPanel>().findChildren<QLabel*>()) {
            if (label->isVisible() && label->text().startsWith("ellipse-h")) {
                titles << label->text();
            }
        }
        return titles.join(" | ").toStdString();
    };
    EXPECT_EQ(titled(), "ellipse-h5-p0: gap 5 mm | ellipse-h2-p0: gap 2 mm");
    auto& numbers = panel<CompareNumbers>();
    std::set<std::pair<std::size_t, int>> bold;
    for (std::size_t row = 1; row < numbers.rows().size(); ++row) {
        for (int column = 0; column < numbers.rows()[row].size(); ++column) {
            for (int at = 0; at < numbers.forces()->columnCount(); ++at) {
                const auto* item = numbers.forces()->item(static_cast<int>(row) - 1, at);
                if (item->font().bold() && item->text() == numbers.rows()[row][column]) {
                    bold.emplace(row, column);
                }
            }
        }
    }
    EXPECT_EQ(numbers.beyond(), bold);
    const QPoint bar = numbers.tabBar()->mapTo(window_.get(), QPoint());
    numbers.setCurrentIndex(2);
    settle(*window_);
    EXPECT_EQ(numbers.tabBar()->mapTo(window_.get(), QPoint()), bar);
    act("select case/ellipse-h5-p0");
    settle(*window_);
    EXPECT_NE(titled().find("0.5 m/s"), std::string::npos) << titled();
}

// The chance of a safe end, and shares over what is swept: the numbers of the library.
TEST_F(Window, MapsOfChanceAndOfASweepAreThoseOfTheLibrary) {
    open(computed_study());
    act("workspace stability");
    act("region glide cells=20 show=probability draws=4");
    settle(*window_);
    auto& stability = panel<RegionPanel>();
    ASSERT_TRUE(stability.probability()) << window_->last_error().toStdString();
    EXPECT_FALSE(stability.region()) << "another map";
    act("region glide show=sweep sweep=speed=0.4:0.6 steps=2");
    settle(*window_);
    ASSERT_TRUE(stability.sweep()) << window_->last_error().toStdString();
    EXPECT_EQ(stability.sweep()->value.size(), 2U);
    window_->desk().undo();
    act("region glide show=ends");
    settle(*window_);
    EXPECT_TRUE(stability.region());
    EXPECT_FALSE(act("region glide show=nothing"));
    EXPECT_FALSE(act("region glide axes=gap=1mm:2mm"));
}

// What the button does is what the command does, and only after a question that names the cost.
TEST_F(Window, CfdOfAShapeIsAskedForWithItsCost) {
    const fs::path folder = copy_of_study();
    open(folder);
    act("set body.base_cut=0.7");
    EXPECT_FALSE(window_->add_to_sweep("cut"));
    EXPECT_EQ(asked_, 1);
    EXPECT_FALSE(fs::exists(folder / "shapes" / "cut.toml"));
    answer_ = true;
    ASSERT_TRUE(window_->add_to_sweep("cut"));
    settle(*window_);
    EXPECT_DOUBLE_EQ(geometry::read_shape(folder / "shapes" / "cut.toml").base_cut, 0.7);
    const auto& study = window_->desk().session().study;
    ASSERT_TRUE(study.sweep);
    ASSERT_EQ(study.sweep->bodies.size(), 1U);
    EXPECT_EQ(study.sweep->bodies[0].name, "cut");
    EXPECT_THROW(window_->add_to_sweep("cut"), core::InputError);
    // By the command, one more, into the list that is there now.
    const auto run = test::run_underbody(
        {"sweep", folder.string(), "--add", (folder / "shapes" / "cut.toml").string(), "--as", "cut-2", "--json"});
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_EQ(nlohmann::json::parse(run.output)["cases"], 1);
    EXPECT_EQ(cases::Study::open(folder).sweep->bodies.size(), 2U);
}

// Over decades of gap the scale is logarithmic, as in Tables; a click is read on the scale that is drawn.
TEST_F(Window, AMapOverDecadesOfGapIsLogarithmic) {
    open(computed_study());
    act("workspace stability");
    act("region glide cells=20");
    settle(*window_);
    auto& stability = panel<RegionPanel>();
    QCheckBox* box = nullptr;
    for (auto* one : stability.findChildren<QCheckBox*>()) {
        box = one->text().contains("garithmic") ? one : box;
    }
    ASSERT_NE(box, nullptr);
    EXPECT_TRUE(box->isEnabled());
    EXPECT_FALSE(box->isChecked()) << "2 to 20 mm";
    act("region glide axes=gap=1mm:100mm,heave_velocity=-0.06:0.06");
    settle(*window_);
    EXPECT_TRUE(box->isChecked()) << "1 to 100 mm";
    box->click();
    EXPECT_EQ(window_->desk().state().regions.at("glide").logarithmic, false);
    settle(*window_);
    EXPECT_FALSE(box->isChecked());
}

// What was exported is remembered; it is stale once its table has changed, and made again as it was made before.
TEST_F(Window, AStaleExportIsSaidAndMadeAgain) {
    const fs::path study = copy_of_study();
    open(study);
    act("workspace tables");
    settle(*window_);
    const std::string file = (folder_.path() / "lift.h").string();
    ExportRecord record;
    record.table = "lift";
    record.made_of = table_digest(window_->desk().session(), "lift");
    record.name = "lift";
    core::write_file(file, "the old one");
    window_->desk().act(words_of_exports({{file, record}}));
    EXPECT_EQ(window_->desk().state().exports.at(file), record);
    EXPECT_TRUE(stale_exports(window_->desk().state(), window_->desk().session()).empty());
    window_->export_stale();
    settle(*window_);
    EXPECT_EQ(core::read_file(file), "the old one") << "nothing is stale";
    fs::remove(study / "fields" / "ellipse-h20-p0.csv");
    window_->desk().reload();
    settle(*window_);
    EXPECT_EQ(stale_exports(window_->desk().state(), window_->desk().session()), std::vector<std::string>{file});
    bool said = false;
    const auto* problems = window_->findChild<ProblemList*>();
    for (int i = 0; i < problems->topLevelItemCount(); ++i) {
        said = said || problems->topLevelItem(i)->text(1).contains("stale");
    }
    EXPECT_TRUE(said);
    window_->export_stale();
    settle(*window_);
    EXPECT_EQ(asked_, 1) << "it is not what the window wrote";
    EXPECT_EQ(core::read_file(file), "the old one");
    answer_ = true;
    window_->export_stale();
    settle(*window_);
    EXPECT_EQ(window_->desk().history().steps().back().name, "export lift.h");
    EXPECT_NE(core::read_file(file).find("#ifndef"), std::string::npos);
    EXPECT_TRUE(stale_exports(window_->desk().state(), window_->desk().session()).empty());
}

// In a small window plots keep room to be read.
TEST_F(Window, PlotsKeepTheirRoomInASmallWindow) {
    open(computed_study());
    for (const QSize small : {QSize(1100, 700), QSize(900, 600), QSize(800, 500)}) {
        window_->resize(small);
        act("workspace design");
        settle(*window_);
        int plots = 0;
        for (auto* plot : panel<DesignPanel>().findChildren<PlotView*>()) {
            auto* drawn = plot->findChild<QCustomPlot*>();
            if (plot->isVisible() && plot->has_figure() && !plot->figure().equal_scales) {
                drawn->replot();
                EXPECT_GE(drawn->axisRect()->height(), 100) << small.width() << ": between the axes of the lift";
                ++plots;
            }
        }
        EXPECT_EQ(plots, 1) << small.width();
    }
    window_->resize(900, 600);
    for (const auto& name : workspace_names()) {
        act("workspace " + name);
        settle(*window_);
        for (const auto* plot : window_->findChildren<PlotView*>()) {
            if (plot->isVisible()) {
                EXPECT_GE(plot->height(), name == "compare" ? 70 : 150) << name;
                EXPECT_GE(plot->width(), 240) << name;
            }
        }
    }
    EXPECT_LE(window_->height(), 760) << "and the window does not grow far beyond what was asked";
}

// Two files of the same bytes are two cases with their loads.
TEST_F(Window, TwoCasesOfEqualBytesAreBothDone) {
    const fs::path folder = folder_.path() / "equal";
    test::make_few_gaps(folder);
    fs::copy_file(folder / "fields" / "ellipse-h5-p0.csv", folder / "fields" / "ellipse-h4-p0.csv");
    const auto run = test::run_underbody({"study", "run", folder.string(), "--no-pictures"});
    open(folder);
    EXPECT_EQ(window_->desk().session().results.loads.rows(), 6U) << run.errors;
    EXPECT_EQ(status_of("ellipse-h3-p0"), "done");
    EXPECT_EQ(status_of("ellipse-h4-p0"), "warning") << "done, and told: one file at two gaps";
    EXPECT_EQ(status_of("ellipse-h5-p0"), "warning");
}

// Pictures are called by what they show and of whom, not by their keys.
TEST_F(Window, NamesOfCasesHaveTheirRoomInTheTree) {
    open(computed_study());
    window_->resize(1280, 800);
    settle(*window_);
    const auto* tree = window_->findChild<StudyTree*>();
    ASSERT_NE(tree, nullptr);
    int widest = 0;
    for (const auto& one : window_->desk().session().study.cases) {
        widest = std::max(widest, QFontMetrics(tree->font()).horizontalAdvance(QString::fromStdString(one.name)));
    }
    EXPECT_GT(widest, 0);
    EXPECT_GE(tree->header()->sectionSize(0), std::min(widest, 220) + 2 * tree->indentation());
}

TEST_F(Window, PicturesHaveTitles) {
    cases::StudyResults results;
    results.documents.emplace_back("picture/level/ellipse-h5-p0/pressure-underbody",
                                   R"({"title": "pressure on the underbody", "caption": "level: seen from below"})");
    results.documents.emplace_back("residual/heave test/0", R"({"title": "residual of heave test", "caption": ""})");
    EXPECT_EQ(picture_title(results, "picture/level/ellipse-h5-p0/pressure-underbody"),
              "pressure on the underbody: ellipse-h5-p0");
    EXPECT_EQ(picture_title(results, "residual/heave test/0"), "residual of heave test");
    EXPECT_EQ(picture_title(results, "figure/a/b"), "a, b");
}

// Colours follow the theme, in plots that were drawn before too.
TEST_F(Window, ADarkThemeReachesEveryPlot) {
    open(computed_study());
    act("workspace tables");
    settle(*window_);
    const auto corner = [&] {
        const QImage image = panel<ForcePanel>().findChild<PlotView*>()->grab().toImage();
        return QColor(image.pixel(3, 3)).lightness();
    };
    EXPECT_GT(corner(), 200);
    set_theme("dark");
    settle(*window_);
    EXPECT_LT(corner(), 90);
    // The title and the key are read on it: there are pale pixels above the axes.
    const QImage image = panel<ForcePanel>().findChild<PlotView*>()->grab().toImage();
    int pale = 0;
    for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < image.width(); ++x) {
            pale += QColor(image.pixel(x, y)).lightness() > 170 ? 1 : 0;
        }
    }
    EXPECT_GT(pale, 20);
    set_theme("system");
    settle(*window_);
    EXPECT_GT(corner(), 200);
}

}  // namespace
}  // namespace underbody::studio
