// Point clouds, as lines of decimal numbers (.xyz, .pts, .csv) and PCD: valid files and every kind of damage.
#include "algorithms/error.h"
#include "datasets/load.h"
#include "tests/support/temporary_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#ifdef HAUSBENCH_HAS_LZF
#include <liblzf/lzf.h>
#endif

#include <cstring>
#include <fstream>

namespace hausbench {
namespace {

using Rows = std::vector<std::array<double, 3>>;

class PointFiles : public ::testing::Test {
protected:
    LoadedShape load(const std::string& name, const std::string& bytes) const {
        std::ofstream(folder_.path() / name, std::ios::binary) << bytes;
        return load_file(folder_.path() / name);
    }
    void reads(const std::string& name, const std::string& bytes, const Rows& expected) const {
        const LoadedShape loaded = load(name, bytes);
        ASSERT_EQ(kind_of(loaded.shape), ShapeKind::points) << bytes;
        const Points& points = points_of(loaded.shape);
        ASSERT_EQ(points.rows(), Eigen::Index(expected.size())) << bytes;
        for (std::size_t i = 0; i < expected.size(); ++i)
            for (std::size_t k = 0; k < 3; ++k)
                EXPECT_EQ(points(Eigen::Index(i), Eigen::Index(k)), expected[i][k]) << bytes << ": " << i << ", " << k;
        EXPECT_EQ(loaded.report.precision, "float64");
    }
    // Expects an error of one line that begins with the file name and contains all `parts`.
    void refused(const std::string& name, const std::string& bytes, const std::vector<std::string>& parts) const {
        try {
            load(name, bytes);
            FAIL() << name << " was read: " << bytes;
        } catch (const InputError& error) {
            const std::string message = error.what();
            EXPECT_TRUE(message.starts_with((folder_.path() / name).string())) << message;
            EXPECT_EQ(message.find('\n'), std::string::npos) << message;
            for (const std::string& part : parts)
                EXPECT_NE(message.find(part), std::string::npos) << message << " lacks " << part;
        }
    }
    TemporaryFolder folder_;
};

template <class T> void put(std::string& bytes, T value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

TEST_F(PointFiles, LinesOfNumbers) {
    const Rows two = {{1, -2.5, 3e-3}, {4, 5, 6}};
    for (const std::string name : {"a.xyz", "a.pts", "a.csv", "A.XYZ"}) {
        reads(name, "1 -2.5 3e-3\n4 5 6\n", two);
        reads(name, "1\t-2.5\t3e-3\r\n4\t5\t6", two);
        reads(name, "\xef\xbb\xbf# x y z\n\n  +1, -2.5 ,3e-3 # here\n// no more\n4,5,6\n", two);
        reads(name, "1;-2.5;3e-3;0.5;255\r4;5;6;0.5;255\r", two);          // old line ends; intensity and a colour
        reads(name, "1 -2.5 3e-3\r4 5 6\r\n", two);                        // the same file, saved again
        reads(name, "1 -2.5 3e-3 nan nan nan\n4 5 6 nan nan nan\n", two);  // unknown normals
    }
}

TEST_F(PointFiles, EveryDigitCounts) {
    // Halfway cases, a subnormal and the largest double must be rounded as strtod rounds them.
    const std::vector<std::string> hard = {
        "9007199254740993",       "0.1", "2.2250738585072011e-308", "4.9e-324", "1e-400",
        "1.7976931348623157e308", "-0",  "0.30000000000000004441",  "8.41e21"};
    for (const std::string& text : hard) {
        const double value = std::strtod(text.c_str(), nullptr);
        reads("a.xyz", fmt::format("{} {} 1\n", text, text), {{value, value, 1}});
    }
}

TEST_F(PointFiles, CountLines) {
    reads("a.pts", "2\n1 2 3 -5 10 20 30\n4 5 6 -5 10 20 30\n", {{1, 2, 3}, {4, 5, 6}});
    reads("a.pts", "1\n1 2 3\n2\n4 5 6\n7 8 9\n", {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}});  // two scans in one file
    reads("a.xyz", "1\n1 2 3\n", {{1, 2, 3}});
    refused("a.pts", "3\n1 2 3\n4 5 6\n", {"is truncated", "line 1 announces 3 points, and 2 are there"});
    refused("a.pts", "1\n1 2 3\n4 5 6\n", {"line 3", "another point, though line 1 announces 1"});
    refused("a.pts", "2\n1 2 3\n2\n4 5 6\n", {"line 3", "1 column, and a point"});
    refused("a.csv", "2\n1,2,3\n", {"line 1", "1 column"});
}

TEST_F(PointFiles, HeadersOfColumns) {
    const Rows one = {{1, 2, 3}};
    reads("a.csv", "x,y,z\n1,2,3\n", one);
    reads("a.csv", "id;\"Z\";\"Y\";\"X\"\n7;3;2;1\n", one);
    reads("a.csv", "//X,Y,Z,Intensity\n1,2,3,9\n", one);  // as CloudCompare writes it
    reads("a.csv", "//Intensity,X,Y,Z\n9,1,2,3\n", one);
    reads("a.csv", "easting,northing,height\n1,2,3\n", one);
    reads("a.xyz", "X Y Z R G B\n1 2 3 4 5 6\n", one);
    refused("a.csv", "x,y,height\n1,2,3\n", {"line 1", "names only some of x, y and z"});
    refused("a.csv", "1.0.0,2,3\n4,5,6\n", {"line 1", "'1.0.0'"});  // a bad number, not a header
    refused("a.csv", "id,z,y,x\n7,3,2\n", {"line 2", "column 4 (x) is missing"});
    refused("a.csv", "x,y,z\nx,y,z\n", {"line 2", "column 1 (x) is 'x', which is not a number"});
    refused("a.csv", "x,y,z\n", {"holds no vertices"});
    refused("a.csv", "x,y,z\n1,2,3\n1,5,2,0,3,0\n",
            {"line 3: 6 columns, and the header names 3", "decimals with a point"});
    refused("a.csv", "name,x,y,z\n\"a,7,8,9,b\",1,2,3\n", {"line 2: 8 columns, and the header names 4"});
    reads("a.csv", "x,y,z\n1,2,3,\n", one);
}

TEST_F(PointFiles, BadLines) {
    refused("a.xyz", "1 2 3\n4 5\n", {"line 2", "2 columns, and a point needs x, y and z"});
    refused("a.csv", "1,2,3\n4,,6\n", {"line 2", "column 2 (y) is empty"});
    refused("a.csv", "1,5;2,5;3,5\n4,5;5;6\n", {"line 1: column 1 (x) is '1,5'", "with a point, not a comma"});
    refused("a.xyz", "1,5 2,5 3,5\n", {"line 1", "column 2 (y) is '5 2'"});
    refused("a.xyz", "1 2 3\n1 nan 3\n", {"line 2", "not finite"});
    refused("a.xyz", "1 2 -inf\n", {"line 1", "not finite"});
    refused("a.xyz", "1 2 1e400\n", {"line 1", "not finite"});
    refused("a.xyz", "2\nwater\nO 0 0 0\nH 0 0 1\n", {"line 2", "not a number"});  // a molecule's .xyz
    refused("a.xyz", "1 2 0x3\n", {"line 1", "column 3 (z) is '0x3'"});
    refused("a.xyz", "1 2 +-3\n", {"line 1", "'+-3'"});
    refused("a.xyz", std::string("\xff\xfe\x31\x00\x20\x00", 6), {"UTF-16", "UTF-8"});
    refused("a.xyz", "# nothing\n", {"holds no vertices"});
    refused("a.laz", "LASF", {"LAZ cannot be read", "convert it to .xyz or .ply", "las2txt"});
}

std::string pcd(const std::string& types, const std::string& sizes, int points, const std::string& data,
                const std::string& fields = "x y z") {
    const std::string ones = "1 1 1 1 1 1";
    const auto count = std::size_t(std::count(fields.begin(), fields.end(), ' ') + 1);
    return fmt::format(
        "# .PCD v0.7\nVERSION 0.7\nFIELDS {}\nSIZE {}\nTYPE {}\nCOUNT {}\nWIDTH {}\nHEIGHT 1\nVIEWPOINT 0 0 "
        "0 1 0 0 0\nPOINTS {}\nDATA {}\n",
        fields, sizes, types, ones.substr(0, 2 * count - 1), points, points, data);
}

TEST_F(PointFiles, PcdAsText) {
    const Rows two = {{0.1, 2, 3}, {4, 5, 6}};
    reads("a.pcd", pcd("F F F", "8 8 8", 2, "ascii") + "0.1 2 3\n4 5 6\n", two);
    reads("a.pcd", pcd("U F F F", "4 8 8 8", 2, "ascii", "rgb z y x") + "7 3 2 0.1\r\n7 6 5 4\r\n", two);
    EXPECT_TRUE(load("a.pcd", pcd("F F F", "4 4 4", 1, "ascii") + "1 2 3\n").report.float32);
    EXPECT_FALSE(load("a.pcd", pcd("F F F", "8 8 8", 1, "ascii") + "1 2 3\n").report.float32);
    refused("a.pcd", pcd("F F F", "8 8 8", 3, "ascii") + "1 2 3\n4 5 6\n", {"the header announces 3 points, and 2"});
    refused("a.pcd", pcd("F F F", "8 8 8", 1, "ascii") + "1 2 3\n4 5 6\n", {"line 13", "announces 1"});
    refused("a.pcd", pcd("F F F", "8 8 8", 1, "ascii") + "1 x 3\n", {"line 12", "column 2 (y) is 'x'"});
    refused("a.pcd", pcd("F F F", "8 8 8", 2, "ascii") + "1 2 3\nnan nan nan\n",
            {"line 13", "point 1 (from 0) is not finite", "remove such points"});
}

// Returns two points as floats, each with one unused byte before it and two after it.
std::string binary_records() {
    std::string body;
    for (const float first : {0.5f, 4.f}) {
        put(body, std::uint8_t{9});
        for (const float value : {first, first + 1, first + 2}) put(body, value);
        put(body, std::uint16_t{7});
    }
    return body;
}

TEST_F(PointFiles, PcdAsBytes) {
    const Rows two = {{0.5, 1.5, 2.5}, {4, 5, 6}};
    const std::string head = pcd("U F F F U", "1 4 4 4 2", 2, "binary", "a x y z b");
    reads("a.pcd", head + binary_records(), two);
    EXPECT_TRUE(load("a.pcd", head + binary_records()).report.float32);
    refused("a.pcd", (head + binary_records()).substr(0, head.size() + 20), {"is truncated", "2 points of 15 bytes"});
    std::string wide, small;
    for (const double value : {1.0 / 3, 2.0, -5.0}) put(wide, value);
    for (const int value : {-1, 2, 3}) put(small, static_cast<std::int16_t>(value));
    reads("a.pcd", pcd("F F F", "8 8 8", 1, "binary") + wide, {{1.0 / 3, 2, -5}});
    reads("a.pcd", pcd("I I I", "2 2 2", 1, "binary") + small, {{-1, 2, 3}});
    EXPECT_FALSE(load("a.pcd", pcd("F F F", "8 8 8", 1, "binary") + wide).report.float32);
    std::string hole = binary_records();
    const float none = std::numeric_limits<float>::quiet_NaN();
    std::memcpy(hole.data() + 5, &none, 4);
    refused("a.pcd", head + hole, {"point 0 (from 0) is not finite", "missing measurement"});
}

TEST_F(PointFiles, PcdCompressed) {
    std::string by_field(2, '\x9');
    for (const float value : {0.5f, 4.f, 1.5f, 5.f, 2.5f, 6.f}) put(by_field, value);
    by_field += std::string("\7\0\7\0", 4);
    const std::string head = pcd("U F F F U", "1 4 4 4 2", 2, "binary_compressed", "a x y z b");
#ifdef HAUSBENCH_HAS_LZF
    std::string packed(100, '\0');
    packed.resize(lzf_compress(by_field.data(), unsigned(by_field.size()), packed.data(), unsigned(packed.size())));
    ASSERT_GT(packed.size(), 0u);
    const auto file = [&](std::uint32_t announced, const std::string& body) {
        std::string all = head;
        put(all, announced);
        put(all, static_cast<std::uint32_t>(by_field.size()));
        return all + body;
    };
    const auto size = static_cast<std::uint32_t>(packed.size());
    reads("a.pcd", file(size, packed), {{0.5, 1.5, 2.5}, {4, 5, 6}});
    refused("a.pcd", file(size, packed.substr(0, 9)), {"is truncated"});
    refused("a.pcd", file(size, std::string(size, '\xff')), {"is damaged"});
    refused("a.pcd", head + "abc", {"is truncated"});
    std::string fewer = file(size, packed);
    fewer.replace(fewer.find("WIDTH 2"), 7, "WIDTH 1").replace(fewer.find("POINTS 2"), 8, "POINTS 1");
    refused("a.pcd", fewer, {"is damaged", "1 points of 15 bytes are announced, and 30 bytes are there"});
    refused("a.pcd", head + std::string("\1\0\0\0\xff\xff\xff\x7f\0", 9), {"is damaged"});
#else
    refused("a.pcd", head + by_field, {"binary_compressed", "liblzf-dev"});
#endif
}

TEST_F(PointFiles, BadPcdHeaders) {
    const std::string good = pcd("F F F", "4 4 4", 1, "ascii") + "1 2 3\n";
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        return text.replace(text.find(from), from.size(), to);
    };
    reads("a.pcd", good, {{1, 2, 3}});
    refused("a.pcd", "hello\n1 2 3\n", {"line 1", "'hello' is not a word of a PCD header"});
    refused("a.pcd", good.substr(0, good.find("DATA")), {"no DATA line"});
    refused("a.pcd", with("FIELDS x y z", "FIELDS x y w"), {"FIELDS has no 'z'"});
    refused("a.pcd", with("SIZE 4 4 4", "SIZE 4 4"), {"line 4", "SIZE has 2 values for 3 FIELDS"});
    refused("a.pcd", with("SIZE 4 4 4", "SIZE 4 4 3"), {"'z' is of type F3"});
    refused("a.pcd", with("COUNT 1 1 1", "COUNT 1 1 2"), {"'z'", "count 2"});
    refused("a.pcd", with("POINTS 1", "POINTS 2"), {"POINTS is 2, and WIDTH times HEIGHT 1"});
    refused("a.pcd", with("POINTS 1", "POINTS -1"), {"line 10", "'-1' is not a whole number"});
    refused("a.pcd", with("WIDTH 1", "WIDTH 1099511627776"), {"WIDTH times HEIGHT"});
    refused("a.pcd", with("DATA ascii", "DATA asci"), {"unknown DATA 'asci'", "did you mean 'ascii'"});
}

}  // namespace
}  // namespace hausbench
