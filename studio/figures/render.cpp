#include "studio/figures/render.h"

#include <qcustomplot.h>

#include <QApplication>
#include <QBuffer>
#include <QFontDatabase>
#include <QHash>
#include <QLibraryInfo>
#include <QPdfWriter>
#include <QPicture>
#include <QThread>
#include <clocale>
#include <cmath>
#include <mutex>

#include "core/error.h"
#include "core/file.h"
#include "studio/figures/elements.h"

namespace underbody::studio {

namespace {

std::mutex drawing;      // Qt widgets are drawn one at a time
bool made_here = false;  // the QApplication is ours: there is no window and no event loop

/// Qt says much that a user of the command line cannot use.
void keep_quiet(QtMsgType type, const QMessageLogContext&, const QString& text) {
    if (type == QtCriticalMsg || type == QtFatalMsg) {
        std::fprintf(stderr, "Qt: %s\n", text.toLocal8Bit().constData());
    }
}

/// Qt aborts when the platform plugin is missing: look before.
void check_platform() {
    QStringList folders = {QLibraryInfo::location(QLibraryInfo::PluginsPath) + "/platforms"};
    if (qEnvironmentVariableIsSet("QT_QPA_PLATFORM_PLUGIN_PATH")) {
        folders << qEnvironmentVariable("QT_QPA_PLATFORM_PLUGIN_PATH");
    }
    for (const auto& folder : folders) {
        if (QFile::exists(folder + "/libqoffscreen.so")) {
            return;
        }
    }
    throw core::SystemError("platform", "Qt's offscreen platform is not installed, so no picture can be drawn", {},
                            "install the Debian package libqt5gui5");
}

void check_fonts() {
    static bool good = false;
    if (good) {
        return;
    }
    if (QFontDatabase().families().isEmpty()) {
        // Fontconfig may know nothing of a font that lies where Debian puts it.
        const QString folder = "/usr/share/fonts/truetype/dejavu/";
        QFontDatabase::addApplicationFont(folder + "DejaVuSans.ttf");
        QFontDatabase::addApplicationFont(folder + "DejaVuSans-Bold.ttf");
    }
    if (QFontDatabase().families().isEmpty()) {
        throw core::SystemError("font", "no font was found, so the text of a picture cannot be drawn", {},
                                "install the Debian package fonts-dejavu-core");
    }
    good = true;
}

/// Call with `drawing` locked.
void start_application() {
    if (QCoreApplication::instance() == nullptr) {
        check_platform();
        static int argc = 3;
        static char name[] = "underbody", option[] = "-platform", platform[] = "offscreen";
        static char* argv[] = {name, option, platform, nullptr};
        const std::string locale = std::setlocale(LC_ALL, nullptr);
        qInstallMessageHandler(keep_quiet);
        qSetGlobalQHashSeed(0);  // Qt draws by the order of its hash tables: two runs would give other bytes
        // Lives to the end of the process: there is no good moment to take it down.
        static auto* application = new QApplication(argc, argv);
        (void)application;
        // Qt takes the user's locale over; the program's numbers must not change with it.
        std::setlocale(LC_ALL, locale.c_str());
        made_here = true;
    }
    if (qobject_cast<QApplication*>(QCoreApplication::instance()) == nullptr) {
        throw core::SystemError("platform", "pictures need a QApplication, and the process has another kind");
    }
    check_fonts();
}

/// Runs `work` where widgets may live.
void on_drawing_thread(const std::function<void()>& work) {
    std::unique_lock lock(drawing);
    start_application();
    if (made_here || QThread::currentThread() == qApp->thread()) {
        work();
        return;
    }
    // A worker of the desktop: the window's thread draws. It may wait for the lock itself, so let it go first.
    lock.unlock();
    std::exception_ptr failure;
    QMetaObject::invokeMethod(
        qApp,
        [&] {
            try {
                work();
            } catch (...) {
                failure = std::current_exception();
            }
        },
        Qt::BlockingQueuedConnection);
    if (failure) {
        std::rethrow_exception(failure);
    }
}

void check(const PictureSize& size) {
    const double width = size.width * size.scale;
    const double height = size.height * size.scale;
    if (!(width >= 1 && height >= 1 && width <= 20000 && height <= 20000)) {
        throw core::InputError(
            "size",
            "a picture of " + std::to_string(size.width) + " x " + std::to_string(size.height) + " px cannot be drawn",
            {}, "give a size between 1 and 20000 pixels a side");
    }
}

void prepare(const core::Figure& figure, const PictureSize& size, QCustomPlot& plot) {
    plot.setViewport(QRect(0, 0, size.width, size.height));
    draw(figure, plot);
    // Ranges and margins that follow from the layout (equal scales, the left edge of the key) need a first one.
    QImage nothing(1, 1, QImage::Format_ARGB32);
    QCPPainter painter(&nothing);
    plot.toPainter(&painter, size.width, size.height);
}

/// A figure on its way to pixels: as drawing commands, where they hold no image (of an image they would hold a PNG,
/// which takes longer than to paint it), else painted.
struct Half {
    QPicture commands;
    QImage painted;
};

QImage blank(const PictureSize& size) {
    QImage image(static_cast<int>(std::lround(size.width * size.scale)),
                 static_cast<int>(std::lround(size.height * size.scale)), QImage::Format_RGB32);
    image.fill(Qt::white);
    return image;
}

/// What the window's thread has to do.
void begin_png(const core::Figure& figure, const PictureSize& size, Half& half) {
    QCustomPlot plot;
    prepare(figure, size, plot);
    const bool images = !figure.classes.empty() || !figure.maps.empty();
    half.painted = images ? blank(size) : QImage();
    QCPPainter painter;
    painter.begin(images ? static_cast<QPaintDevice*>(&half.painted) : &half.commands);
    if (size.scale != 1) {
        painter.setMode(QCPPainter::pmNonCosmetic);
    }
    if (images) {
        painter.scale(size.scale, size.scale);
    } else {
        painter.setMode(QCPPainter::pmNoCaching);
    }
    plot.toPainter(&painter, size.width, size.height);
}

/// What any thread may do, and takes longest: the pixels are the same.
std::string finish_png(const PictureSize& size, Half& half) {
    if (half.painted.isNull()) {
        half.painted = blank(size);
        QPainter painter(&half.painted);
        painter.scale(size.scale, size.scale);
        painter.drawPicture(0, 0, half.commands);
    }
    QByteArray bytes;
    QBuffer buffer(&bytes);
    buffer.open(QIODevice::WriteOnly);
    if (!half.painted.save(&buffer, "PNG")) {
        throw core::SystemError("memory", "the picture could not be encoded");
    }
    return bytes.toStdString();
}

std::string pdf(const core::Figure& figure, const PictureSize& size) {
    QCustomPlot plot;
    prepare(figure, size, plot);
    QByteArray bytes;
    QBuffer buffer(&bytes);
    buffer.open(QIODevice::WriteOnly);
    {
        QPdfWriter writer(&buffer);
        writer.setCreator("Underbody");
        writer.setTitle(QString::fromStdString(figure.title));
        constexpr int resolution = 1200;
        writer.setResolution(resolution);
        const QSizeF millimetres(size.width * 25.4 / 96, size.height * 25.4 / 96);
        writer.setPageSize(QPageSize(millimetres, QPageSize::Millimeter, {}, QPageSize::ExactMatch));
        writer.setPageMargins(QMarginsF(0, 0, 0, 0));
        QCPPainter painter;
        if (!painter.begin(&writer)) {
            throw core::SystemError("memory", "the PDF could not be written");
        }
        painter.setMode(QCPPainter::pmVectorized);
        painter.setMode(QCPPainter::pmNoCaching);
        painter.setMode(QCPPainter::pmNonCosmetic);
        painter.scale(resolution / 96.0, resolution / 96.0);
        plot.toPainter(&painter, size.width, size.height);
    }
    // The same figure gives the same bytes: the date of writing goes.
    const int date = bytes.indexOf("/CreationDate (D:");
    const int end = date < 0 ? -1 : bytes.indexOf(')', date);
    for (int i = date < 0 ? end : date + 17; i < end; ++i) {
        if (bytes[i] >= '0' && bytes[i] <= '9') {
            bytes[i] = i - (date + 17) == 5 || i - (date + 17) == 7 ? '1' : (i == date + 17 ? '2' : '0');
        }
    }
    return bytes.toStdString();
}

}  // namespace

std::string render_png(const core::Figure& figure, const PictureSize& size) {
    check(size);
    Half half;
    on_drawing_thread([&] { begin_png(figure, size, half); });
    return finish_png(size, half);
}

std::string render_pdf(const core::Figure& figure, const PictureSize& size) {
    check(size);
    std::string bytes;
    on_drawing_thread([&] { bytes = pdf(figure, size); });
    return bytes;
}

void write_picture(const core::Figure& figure, const std::filesystem::path& path, const PictureSize& size) {
    const std::string ending = path.extension().string();
    if (ending != ".png" && ending != ".pdf") {
        throw core::UsageError("format", "a picture cannot be written as '" + path.string() + "'", {},
                               "the ending must be .png or .pdf");
    }
    core::write_file(path, ending == ".png" ? render_png(figure, size) : render_pdf(figure, size));
}

}  // namespace underbody::studio
