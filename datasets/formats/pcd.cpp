// Reads PCD, the format of the Point Cloud Library: DATA ascii, binary, and binary_compressed if liblzf is built in.
//
// The points are the fields x, y and z, which may have any type of number. An organised cloud (HEIGHT over 1) is a list
// of points like any other; a missing measurement in it is NaN, which finish() refuses or drops. VIEWPOINT, the pose of
// the sensor, does not move the points, because the format only says that it may be used to; a note tells a pose other
// than the identity. The format states no unit and no axes. A coordinate is exactly the stored number, or the float32
// or float64 nearest to the decimal number of a text file.
#include "algorithms/error.h"
#include "datasets/formats/parse.h"
#include "datasets/formats/point_lines.h"

#ifdef HAUSBENCH_HAS_LZF
#include <liblzf/lzf.h>
#endif

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

namespace hausbench::readers {
namespace {

struct Field {
    std::string_view name;
    Stored type;
    std::uint64_t count = 1;
    std::uint64_t offset = 0, column = 0;  // position in bytes within the data of a point; index in a line of text
};

constexpr std::uint64_t most = std::uint64_t{1} << 40;  // limit on the numbers in a header; larger ones are damage

struct PcdHeader {
    std::vector<Field> fields;
    std::array<Field, 3> axes;                          // the fields x, y and z
    std::uint64_t points = 0, record = 0, columns = 0;  // number of points; bytes and numbers of one point
    std::string_view data, body;                        // the word after DATA; the bytes after the header
    std::uint32_t lines = 0;                            // of the header
    std::vector<std::string> notes;
};

class PcdHeaderReader {
public:
    PcdHeaderReader(const std::string& name, std::string_view bytes) : name_(name) { header_.body = bytes; }

    PcdHeader read() {
        while (header_.data.empty()) {
            if (header_.body.empty()) throw InputError(name_ + ": is not a PCD file: it has no DATA line");
            std::string_view line = next_line(header_.body);
            ++header_.lines;
            line = line.substr(0, line.find('#'));
            if (const std::string_view key = next_word(line); !key.empty()) take(key, line);
        }
        place_fields();
        find_axes();
        count_points();
        return std::move(header_);
    }

private:
    [[noreturn]] void refuse_line(const std::string& why) const { refuse(name_, header_.lines, why); }

    void take(std::string_view key, std::string_view line) {
        std::vector<std::string_view> values;
        for (auto word = next_word(line); !word.empty(); word = next_word(line)) values.push_back(word);
        if (key == "VERSION") return;
        if (key == "VIEWPOINT") return note_pose(values);
        const bool single = key == "WIDTH" || key == "HEIGHT" || key == "POINTS" || key == "DATA";
        if (single && values.size() != 1) refuse_line(fmt::format("{} needs one value", key));
        if (key == "FIELDS" || key == "COLUMNS") {
            for (const std::string_view value : values) header_.fields.push_back({value, {}});
        } else if (key == "SIZE" || key == "TYPE" || key == "COUNT") {
            if (values.size() != header_.fields.size())
                refuse_line(fmt::format("{} has {} values for {} FIELDS", key, values.size(), header_.fields.size()));
            for (std::size_t i = 0; i < values.size(); ++i) {
                Field& field = header_.fields[i];
                if (key == "TYPE")
                    field.type.kind = values[i].front();
                else
                    (key == "SIZE" ? field.type.size : field.count) = number(values[i]);
            }
        } else if (key == "DATA") {
            header_.data = values.front();
        } else if (single) {
            counts_[key] = number(values.front());
        } else {
            refuse_line(fmt::format("'{}' is not a word of a PCD header: is it a PCD file?", shown(key)));
        }
    }

    void note_pose(const std::vector<std::string_view>& values) {
        const bool short_one = values.size() == 3;  // an origin alone, in early files
        std::string text;
        bool identity = values.size() == 7 || short_one;
        for (std::size_t i = 0; i < values.size(); ++i) {
            const auto value = decimal(values[i]);
            identity = identity && value && std::abs(*value) == (i == 3 ? 1 : 0);
            text += (i == 0 ? "" : " ") + shown(values[i]);
        }
        if (!identity)
            header_.notes.push_back(
                fmt::format("its VIEWPOINT {}, the pose of the sensor, does not move the points", text.substr(0, 100)));
    }

    std::uint64_t number(std::string_view text) const {
        const auto value = whole<std::uint64_t>(text);
        if (!value || *value > most) refuse_line(fmt::format("'{}' is not an integer up to 2^40", shown(text)));
        return *value;
    }

    void place_fields() {
        std::uint64_t column = 0;
        for (Field& field : header_.fields) {
            field.offset = header_.record;
            field.column = column;
            if (field.type.size > most / 1024 || field.count > 1024)
                refuse_line("a field is larger than any point: damaged");
            header_.record += field.type.size * field.count;
            column += field.count;
        }
        header_.columns = column;
    }

    void find_axes() {
        const bool capitals = std::none_of(header_.fields.begin(), header_.fields.end(), [](const Field& f) {
            return f.name == "x" || f.name == "y" || f.name == "z";
        });
        for (std::size_t k = 0; k < 3; ++k) {
            const std::string name(1, (capitals ? "XYZ" : "xyz")[k]);
            const auto field = std::find_if(header_.fields.rbegin(), header_.fields.rend(),
                                            [&](const Field& f) { return f.name == name; });
            if (field == header_.fields.rend())
                refuse_line(fmt::format("FIELDS has no '{}': name the coordinates x, y and z", "xyz"[k]));
            if (std::count_if(header_.fields.begin(), header_.fields.end(),
                              [&](const Field& f) { return f.name == name; }) > 1)
                refuse_line(fmt::format("FIELDS has '{}' twice: give the other field another name", name));
            if (field->count != 1 || !field->type.readable())
                refuse_line(fmt::format("'{}' is of type {}{} and count {}: write it as one F of 4 or 8 bytes", name,
                                        field->type.kind, field->type.size, field->count));
            header_.axes[k] = *field;
        }
    }

    void count_points() {
        const bool shaped = counts_.contains("WIDTH") && counts_.contains("HEIGHT");
        const std::uint64_t width = counts_["WIDTH"], height = counts_["HEIGHT"];
        if (!counts_.contains("POINTS") && !shaped) refuse_line("the header has neither POINTS nor WIDTH and HEIGHT");
        if (height > 0 && width > most / height) refuse_line("WIDTH times HEIGHT is more points than any file has");
        header_.points = counts_.contains("POINTS") ? counts_["POINTS"] : width * height;
        if (shaped && header_.points != width * height)
            refuse_line(fmt::format("POINTS is {}, and WIDTH times HEIGHT {}", header_.points, width * height));
    }

    const std::string& name_;
    PcdHeader header_;
    std::map<std::string_view, std::uint64_t> counts_;
};

// Reads binary points. They are stored point by point or, if `by_field` as in a compressed file, field by field: the x
// of all points, then the y of all points, and so on.
Soup from_binary(const std::string& name, const PcdHeader& header, std::string_view body, bool by_field) {
    if (header.points > 0 && body.size() / header.points < header.record)
        throw InputError(fmt::format("{}: is truncated: {} points of {} bytes are announced, and {} bytes are there",
                                     name, header.points, header.record, body.size()));
    Soup soup;
    soup.points.resize(header.points);
    for (std::uint64_t i = 0; i < header.points; ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            const Field& field = header.axes[k];
            const std::uint64_t at =
                by_field ? field.offset * header.points + i * field.type.size : i * header.record + field.offset;
            soup.points[i][static_cast<Eigen::Index>(k)] = field.type.value(body.data() + at);
        }
    return soup;
}

std::string inflated(const std::string& name, std::string_view body) {
#ifdef HAUSBENCH_HAS_LZF
    std::uint32_t packed = 0, full = 0;
    if (body.size() >= 8) {
        std::memcpy(&packed, body.data(), 4);
        std::memcpy(&full, body.data() + 4, 4);
    }
    if (body.size() < 8 || body.size() - 8 < packed)
        throw InputError(fmt::format("{}: is truncated: {} compressed bytes are announced, and {} are there", name,
                                     packed, body.size() < 8 ? 0 : body.size() - 8));
    // LZF writes at most 264 bytes for each 3 that it reads, 88 for one. If the header announces more, the file is
    // damaged, and allocating that much memory would be a waste.
    if (full / 88 > packed) throw InputError(name + ": is damaged: its bytes cannot inflate to the announced size");
    std::string out(full, '\0');
    if (lzf_decompress(body.data() + 8, packed, out.data(), full) != full)
        throw InputError(name + ": is damaged: its compressed bytes cannot be inflated");
    return out;
#else
    (void)body;
    throw InputError(name +
                     ": its data are binary_compressed, which this build cannot read: write it as binary, or install "
                     "liblzf-dev and build again");
#endif
}

}  // namespace

Soup read_pcd(const Input& input) {
    const std::string& name = input.name;
    const std::string_view bytes = input.bytes;
    const PcdHeader header = PcdHeaderReader(name, bytes).read();
    Soup soup;
    if (header.data == "ascii") {
        const auto& [x, y, z] = header.axes;
        PointLines points(name, {x.column, y.column, z.column},
                          {x.type.is_float32(), y.type.is_float32(), z.type.is_float32()}, header.columns,
                          header.points);
        points.add_lines(header.body, header.lines + 1);
        soup = points.finish();
    } else if (header.data == "binary") {
        soup = from_binary(name, header, header.body, false);
        // PCL fills the last block of its files with zeros. Other bytes, if there are enough for a point, are points
        // that the header does not announce, or of another size.
        const std::string_view rest = header.body.substr(header.points * header.record);
        const bool padding = rest.size() < header.record || rest.find_first_not_of('\0') == std::string_view::npos;
        if (padding && !rest.empty())
            soup.notes.push_back(fmt::format("{} bytes after its last point were left out", rest.size()));
        if (!padding)
            throw InputError(
                fmt::format("{}: is damaged: {} points of {} bytes are announced, and {} bytes are there: "
                            "correct its header",
                            name, header.points, header.record, header.body.size()));
    } else if (header.data == "binary_compressed") {
        const std::string fields = inflated(name, header.body);
        // More bytes mean that the number of points is wrong; then all fields after the first would begin elsewhere.
        if (fields.size() > header.points * header.record)
            throw InputError(fmt::format("{}: is damaged: {} points of {} bytes are announced, and {} bytes are there",
                                         name, header.points, header.record, fields.size()));
        soup = from_binary(name, header, fields, true);
    } else {
        refuse(name, header.lines,
               fmt::format("unknown DATA '{}'{}", shown(header.data),
                           nearest_hint(header.data, {"ascii", "binary", "binary_compressed"})));
    }
    soup.notes.insert(soup.notes.begin(), header.notes.begin(), header.notes.end());
    soup.float32 =
        std::any_of(header.axes.begin(), header.axes.end(), [](const Field& f) { return f.type.is_float32(); });
    return soup;
}

}  // namespace hausbench::readers
