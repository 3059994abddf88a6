#include "harness/check/certificate_file.h"

#include "algorithms/error.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/printable.h"
#include "datasets/hash.h"
#include "harness/ask/json_values.h"
#include "harness/ask/tolerance.h"
#include "harness/check/verify.h"
#include "process/whole_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

namespace hausbench {

using nlohmann::json;
namespace fs = std::filesystem;

namespace {

constexpr int format_version = 2;
constexpr double most_above_upper = 1e-12;  // as a fraction of the diagonal of the box around both shapes
constexpr double most_off_rotation = 1e-9;  // largest deviation of an entry of R^T R from the identity
constexpr double most_rounded = 1e-6;       // largest rounding of posed coordinates, as a fraction of the shape

// --- the file ---------------------------------------------------------------------------------------------------------

constexpr std::string_view seal_begin = "\nsha256 ";
constexpr std::size_t seal_length = seal_begin.size() + 64 + 1;

// Returns the *seal*, the last line of a certificate file, with the SHA-256 of `bytes`, all bytes before it.
std::string seal_of(std::string_view bytes) {
    return std::string(seal_begin) + Sha256().add(bytes.data(), bytes.size()).hex() + '\n';
}

// Checks the SHA-256 in the last line, and returns the file without this line. Throws if any byte was changed.
std::string_view unsealed(std::string_view file) {
    const std::size_t length = file.size() < seal_length ? 0 : file.size() - seal_length;
    const std::string_view content = file.substr(0, length);
    const std::string_view seal = file.substr(length);
    if (!seal.starts_with(seal_begin)) throw std::runtime_error("it does not end in its SHA-256");
    if (WATCHED("certificate file: its SHA-256", seal != seal_of(content)))
        throw std::runtime_error("damaged: its SHA-256 does not match");
    return content;
}

json model_json(const CertificateFile::Model& m) { return {{"file", m.file}, {"sha256", m.sha256}, {"pose", m.pose}}; }

// Returns j if it is an array of exactly `count` values; throws otherwise.
const json& numbers(const json& j, std::size_t count) {
    if (WATCHED("certificates: poses have twelve numbers, points three", !j.is_array() || j.size() != count))
        throw std::runtime_error(fmt::format("not {} numbers", count));
    return j;
}

CertificateFile::Model model_of(const json& j) { return {j.at("file"), j.at("sha256"), numbers(j.at("pose"), 12)}; }

// Returns j as an integer of at least `least`. Throws if j is not one or does not fit into T, because converting it
// would be undefined behaviour.
template <class T> T whole(const json& j, T least) {
    const bool unsigned_one = j.is_number_unsigned();
    const bool fits = unsigned_one ? std::in_range<T>(j.get<std::uint64_t>())
                                   : j.is_number_integer() && std::in_range<T>(j.get<std::int64_t>());
    if (WATCHED("certificates: whole numbers", !fits || j.get<T>() < least))
        throw std::runtime_error(fmt::format("not an integer of at least {} that fits", least));
    return j.get<T>();
}

// Parses the first line. Throws on a duplicate key, because two JSON readers may use different values for it.
json parse_header(std::string_view line) {
    std::vector<std::set<std::string>> keys;  // the keys of each open object
    return json::parse(line.begin(), line.end(), [&](int, json::parse_event_t event, json& parsed) {
        if (event == json::parse_event_t::object_start) keys.emplace_back();
        if (event == json::parse_event_t::object_end) keys.pop_back();
        if (event == json::parse_event_t::key &&
            WATCHED("certificates: a key stands once", !keys.back().insert(parsed.get<std::string>()).second))
            throw std::runtime_error("a key occurs twice");
        return true;
    });
}

template <class E> E named(const json& name, std::initializer_list<E> all) {
    for (E value : all) {
        if (name == to_string(value)) return value;
    }
    throw std::runtime_error("no such name");
}
Witness::Direction direction_of(const json& name) {
    return named(name, {Witness::Direction::source_to_target, Witness::Direction::target_to_source});
}

json header(const CertificateFile& c) {
    json certificates = json::array();
    for (const Certificate& certificate : c.certificates) {
        certificates.push_back({{"format", certificate.format},
                                {"direction", to_string(certificate.direction)},
                                {"proven", number(certificate.proven)},
                                {"bytes", certificate.bytes.size()}});
    }
    return {{"hausbench_certificate", format_version},
            {"source", model_json(c.source)},
            {"target", model_json(c.target)},
            {"quantity", to_string(c.quantity)},
            {"solver", c.solver},
            {"tolerance", number(c.tolerance)},
            {"tolerance_of", c.tolerance_of},
            {"lower", number(c.bounds.lower)},
            {"upper", number(c.bounds.upper)},
            {"witness",
             {{"direction", to_string(c.witness.direction)},
              {"source_point", c.witness.source_point},
              {"target_point", c.witness.target_point},
              {"source_element", c.witness.source_element},
              {"target_element", c.witness.target_element}}},
            {"certificates", std::move(certificates)}};
}

CertificateFile parse(std::string_view bytes) {
    const std::size_t end = std::min(bytes.find('\n'), bytes.size());
    if (end == bytes.size()) throw std::runtime_error("it has no first line");
    const json j = parse_header(bytes.substr(0, end));
    if (whole<int>(j.at("hausbench_certificate"), 0) != format_version) throw std::runtime_error("another version");
    CertificateFile c;
    c.source = model_of(j.at("source"));
    c.target = model_of(j.at("target"));
    c.quantity = named(j.at("quantity"), {Quantity::directed, Quantity::symmetric});
    c.solver = j.at("solver");
    c.tolerance = j.at("tolerance").is_number() ? number(j.at("tolerance")) : throw std::runtime_error("no tolerance");
    c.tolerance_of = j.at("tolerance_of");
    c.bounds = {number(j.at("lower")), number(j.at("upper"))};
    const json& w = j.at("witness");
    c.witness = {numbers(w.at("source_point"), 3), numbers(w.at("target_point"), 3),
                 whole<Index>(w.at("source_element"), -1), whole<Index>(w.at("target_element"), -1),
                 direction_of(w.at("direction"))};
    std::size_t at = end + 1;
    for (const json& entry : j.at("certificates")) {
        const std::size_t size = whole<std::size_t>(entry.at("bytes"), 0);
        if (size > bytes.size() - at) throw std::runtime_error("it ends too early");
        c.certificates.push_back({entry.at("format"), direction_of(entry.at("direction")), number(entry.at("proven")),
                                  std::string(bytes.substr(at, size))});
        at += size;
    }
    if (WATCHED("certificate file: nothing after the last certificate", at != bytes.size()))
        throw std::runtime_error("it goes on after its last certificate");
    return c;
}

// --- the check -----------------------------------------------------------------------------------------------------------

void expect_shape(const CertificateFile::Model& model, const Shape& shape, const char* name) {
    const std::string hash = content_hash(shape);
    if (WATCHED_ELSE("certificate file: the shapes are those that were measured", hash == model.sha256, true)) return;
    throw InputError(
        fmt::format("{}: this is not the shape of the certificate: its coordinates and indices have the SHA-256 {}, "
                    "not {}; give the file that was measured as {}",
                    model.file, hash, model.sha256, name));
}

// Returns whether a pose is a rotation and translation, up to rounding. A pose that flattened a shape would make any
// bound true.
bool keeps_distances(const Pose& pose) {
    const Eigen::Matrix3d off = pose.rotation.transpose() * pose.rotation - Eigen::Matrix3d::Identity();
    return WATCHED_ELSE("certificates: a pose keeps distances",
                        (off.array().abs() <= most_off_rotation).all() && pose.translation.allFinite(), true);
}

// Returns a bound on how far rounding moves the posed points from where the pose puts them. Each coordinate has three
// products and three sums, none of which is larger than 3 R + T, so that its error is below 8 u (3 R + T), where R is the
// largest coordinate, T that of the translation, and u = 2^-53. (An entry of a rotation is at most 1 + 1e-9.)
double rounding_of(const Shape& shape, const Pose& pose) {
    if (pose.is_identity()) return 0;
    return std::sqrt(3) * 0x1p-50 * (3 * magnitude(points_of(shape)) + pose.translation.cwiseAbs().maxCoeff());
}

// Returns the diagonal of the box around both shapes in the poses of the file.
double extent_of(const CertificateFile& c, const Shape& source, const Shape& target) {
    return diagonal_of_both(posed(points_of(source), c.source.pose), posed(points_of(target), c.target.pose));
}

double proven_by(const CertificateFile& c) {
    double proven = 0;
    for (const Certificate& certificate : c.certificates) proven = std::max(proven, certificate.proven);
    return proven;
}

// Returns why the poses cannot count as motions: one of them is not a rotation and translation, or rounding flattens a
// shape or moves it against the other, because a coordinate is so large. The size of the other shape does not matter: a
// shape that is flattened onto a point of a large one would be at distance 0 from it.
std::string wrong_pose(const CertificateFile& c, const Shape& source, const Shape& target) {
    for (const auto& [name, model, shape] : {std::tuple{"A", &c.source, &source}, {"B", &c.target, &target}}) {
        if (!keeps_distances(model->pose)) return fmt::format("the pose of {} is not a rotation and translation", name);
        const double size = WATCHED_ELSE(
                         "certificate: a shape is not flattened onto a large one",
                         std::max(diagonal(points_of(*shape)), proven_by(c)),
                         std::max({diagonal(points_of(source)), diagonal(points_of(target)), proven_by(c)})),
                     rounding = rounding_of(*shape, model->pose);
        if (WATCHED("certificate: a pose does not flatten a shape by rounding",
                    rounding != 0 && !(rounding <= most_rounded * size && std::isfinite(size))))
            return fmt::format(
                "the pose of {} moves it so far that rounding displaces its points by up to {:.2g}, more than "
                "1e-6 of its diagonal or of the bound",
                name, rounding);
    }
    return "";
}

// Returns whether the file has exactly the certificates that its quantity requires: one of h(A,B) and, for H(A,B), then
// one of h(B,A).
bool proves_its_quantity(const CertificateFile& c) {
    using Direction = Witness::Direction;
    std::vector<Direction> wanted = {Direction::source_to_target};
    if (c.quantity == Quantity::symmetric) wanted.push_back(Direction::target_to_source);
    return std::equal(
        c.certificates.begin(), c.certificates.end(), wanted.begin(), wanted.end(),
        [](const Certificate& certificate, Direction direction) { return certificate.direction == direction; });
}

// Checks the lower bound of the answer. Returns the result as text, and sets `wrong` if the file must be refused.
std::string check_lower(const CertificateFile& c, const Shape& source, const Shape& target, bool& wrong) {
    const double lower = c.bounds.lower;
    const Vec3& p =
        c.witness.direction == Witness::Direction::source_to_target ? c.witness.source_point : c.witness.target_point;
    wrong = !(lower >= 0 && std::isfinite(lower)) ||
            (c.quantity == Quantity::directed && c.witness.direction == Witness::Direction::target_to_source);
    if (wrong) return "it is not a lower bound of this distance";
    wrong = WATCHED("certificates: elements that are there", c.witness.source_element >= element_count(source) ||
                                                                 c.witness.target_element >= element_count(target));
    if (wrong) return "its witness names an element that the shape does not have";
    if (lower == 0) return "holds: no distance is below 0";
    wrong = WATCHED_ELSE("certificate: a lower bound without a witness is not proven", true, p.allFinite());
    if (lower > c.bounds.upper) return "it is above the upper bound";
    if (!p.allFinite()) return "it has no witness, so nothing shows it";
    double shown = 0;
    const Verdict verdict = Checker(source, target).lower(lower, c.witness, c.source.pose, c.target.pose, shown);
    wrong = verdict != Verdict::holds;
    if (!wrong) return "holds, by its witness";
    if (verdict != Verdict::unsound) return "it cannot be checked, because a pose leaves the range of doubles";
    return fmt::format("its witness shows only {:.17g}", shown);
}

}  // namespace

bool proves_the_bound(double proven, double upper, double extent) {
    return proven <= upper ||
           (WATCHED_ELSE("certificate: shapes whose diagonal is not a double", std::isfinite(extent), true) &&
            proven - upper <= most_above_upper * extent);
}

void state_what_is_proven(CertificateFile& content, const Shape& source, const Shape& target) {
    const double proven = proven_by(content);
    if (proves_the_bound(proven, content.bounds.upper, extent_of(content, source, target)))
        content.bounds.upper =
            std::max(content.bounds.upper, WATCHED("certificate: a file states what it proves", proven));
}

void take_answer(CertificateFile& content, Result answer, const Shape& source, const Shape& target) {
    content.source.sha256 = content_hash(source);
    content.target.sha256 = content_hash(target);
    content.bounds = answer.bounds;
    content.witness = answer.witness;
    content.certificates = std::move(answer.certificates);
    state_what_is_proven(content, source, target);
}

Shape as_loaded(const PreparedShape& prepared) {
    Shape shape = prepared.shape();
    points_of(shape) = prepared.original();
    return shape;
}

void write_certificate(const fs::path& file, const CertificateFile& content) {
    std::string bytes = header(content).dump(-1, ' ', false, json::error_handler_t::replace) + '\n';
    for (const Certificate& certificate : content.certificates) bytes += certificate.bytes;
    write_whole_file(file, bytes + seal_of(bytes));
}

CertificateFile read_certificate(const fs::path& file) {
    std::error_code none;
    std::ifstream in;
    if (fs::is_regular_file(file, none)) in.open(file, std::ios::binary);  // opening a pipe would wait for its writer
    if (!in.is_open())
        throw InputError(
            fmt::format("{}: cannot be read: name a file that `measure --certificate` wrote", file.string()));
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    try {
        return parse(unsealed(bytes));
    } catch (const std::exception& error) {
        throw InputError(printable(fmt::format("{}: is not a certificate file of version {} ({})", file.string(),
                                               format_version, error.what())));
    }
}

CertificateVerdict verify_certificate(const CertificateFile& content, const Shape& source, const Shape& target,
                                      const std::function<void()>& looking) {
    expect_shape(content.source, source, "A");
    expect_shape(content.target, target, "B");
    CertificateVerdict verdict;
    const auto refuse = [&](const std::string& why) {
        if (verdict.refusal.empty()) verdict.refusal = why;
    };
    if (const std::string wrong = wrong_pose(content, source, target); !wrong.empty()) refuse(wrong);
    if (WATCHED("certificate file: H takes both directions", !proves_its_quantity(content)))
        refuse(content.quantity == Quantity::symmetric ? "H(A,B) takes a certificate of h(A,B) and one of h(B,A)"
                                                       : "h(A,B) takes one certificate, of h(A,B)");
    for (const Certificate& certificate : content.certificates) {
        verdict.checks.push_back(
            check_certificate(source, content.source.pose, target, content.target.pose, certificate, looking));
        if (WATCHED_ELSE("certificate file: every certificate is accepted",
                         WATCHED("fuzz target of certificates: an upper bound that its leaves do not show",
                                 !verdict.checks.back().accepted),
                         false))
            refuse(verdict.checks.back().refusal);
    }
    verdict.proven = proven_by(content);
    if (WATCHED_ELSE("certificate file: what is proven is the upper bound of the answer",
                     WATCHED("fuzz target of certificates: an upper bound below what is proven",
                             !(verdict.proven <= content.bounds.upper)),
                     false))
        refuse(fmt::format("it proves {:.17g}, which is above the upper bound {:.17g}", verdict.proven,
                           content.bounds.upper));
    bool wrong = false;
    verdict.lower = check_lower(content, source, target, wrong);
    if (WATCHED_ELSE("certificate file: the lower bound",
                     WATCHED("fuzz target of certificates: a lower bound that its witness does not show", wrong),
                     false))
        refuse(fmt::format("lower bound {:.17g}: {}", content.bounds.lower, verdict.lower));
    verdict.accepted = verdict.refusal.empty();
    return verdict;
}

std::string describe(const CertificateFile& content, const CertificateVerdict& verdict) {
    std::string text = fmt::format(
        "answer     of {}: {} in [{:.17g}, {:.17g}]\n",
        WATCHED_ELSE("certificates: text of the file is filtered", printable(content.solver), content.solver),
        content.quantity == Quantity::symmetric ? "H(A,B)" : "h(A,B)", content.bounds.lower, content.bounds.upper);
    for (const auto& [name, model] : {std::pair{'A', &content.source}, std::pair{'B', &content.target}}) {
        if (model->pose.is_identity()) continue;
        text += fmt::format("pose of {}  {} (rotation row by row, translation)\n", name, json(model->pose).dump());
    }
    for (std::size_t i = 0; i < verdict.checks.size(); ++i) {
        const CertificateCheck& check = verdict.checks[i];
        const Certificate& certificate = content.certificates[i];
        const bool forward = certificate.direction == Witness::Direction::source_to_target;
        text += fmt::format("{}     claims <= {:.17g}, its leaves show {:.17g}\n", forward ? "h(A,B)" : "h(B,A)",
                            certificate.proven, check.found);
        text += fmt::format("           {} cuts, {} leaves (one {}, centre {}, vertex {}){}; {:.3f} s\n", check.cuts,
                            check.leaves(), check.one, check.centre, check.vertex,
                            std::isfinite(check.found) ? fmt::format(", the largest in triangle {}", check.worst) : "",
                            check.seconds);
    }
    text += fmt::format("lower      {:.17g} {}\n", content.bounds.lower, verdict.lower);
    return text + (verdict.accepted ? fmt::format("accepted   the distance {}is at most {:.17g}\n",
                                                  content.at_rest() ? "" : "at these poses ", verdict.proven)
                                    : fmt::format("refused    {}\n", verdict.refusal));
}

}  // namespace hausbench
