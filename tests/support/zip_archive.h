// Writes ZIP archives, sound and damaged, for tests.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <string>
#include <vector>

namespace hausbench {

struct ZipEntry {
    std::string name, bytes;
    bool deflated = true;
    bool zip64 = false;  // puts the sizes and the place into the ZIP64 field
    std::uint16_t flags = 0;
    int method = -1;              // instead of 0 or 8
    std::int64_t said_size = -1;  // instead of the size
    bool wrong_checksum = false;
    std::string other_name = {};  // in the local header
};

inline std::string little_endian(std::uint64_t value, int size) {
    std::string bytes;
    for (; size > 0; --size, value >>= 8U) bytes += static_cast<char>(value & 255U);
    return bytes;
}

// Returns the bytes by the method 'deflate', without a header.
inline std::string raw_deflate(const std::string& bytes) {
    z_stream stream{};
    deflateInit2(&stream, 9, Z_DEFLATED, -15, 8, Z_DEFAULT_STRATEGY);
    std::string packed(deflateBound(&stream, bytes.size()), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    deflate(&stream, Z_FINISH);
    packed.resize(stream.total_out);
    deflateEnd(&stream);
    return packed;
}

inline std::string zip_archive(const std::vector<ZipEntry>& entries, const std::string& comment = "") {
    constexpr std::uint64_t elsewhere = 0xffffffff;
    std::string all, directory;
    bool zip64 = false;
    for (const ZipEntry& entry : entries) {
        const std::string packed = entry.deflated ? raw_deflate(entry.bytes) : entry.bytes;
        const std::uint64_t crc =
            crc32(0, reinterpret_cast<const Bytef*>(entry.bytes.data()), static_cast<uInt>(entry.bytes.size())) ^
            (entry.wrong_checksum ? 1U : 0U);
        const std::uint64_t size =
            entry.said_size < 0 ? entry.bytes.size() : static_cast<std::uint64_t>(entry.said_size);
        const auto method = static_cast<std::uint64_t>(entry.method < 0 ? (entry.deflated ? 8 : 0) : entry.method);
        const auto shared = [&](bool far) {
            return little_endian(20, 2) + little_endian(entry.flags, 2) + little_endian(method, 2) +
                   little_endian(0, 4) + little_endian(crc, 4) + little_endian(far ? elsewhere : packed.size(), 4) +
                   little_endian(far ? elsewhere : size, 4);
        };
        const std::string local = entry.other_name.empty() ? entry.name : entry.other_name;
        const std::string extra = entry.zip64
                                      ? little_endian(0x9999, 2) + little_endian(1, 2) + "x" + little_endian(1, 2) +
                                            little_endian(24, 2) + little_endian(size, 8) +
                                            little_endian(packed.size(), 8) + little_endian(all.size(), 8)
                                      : "";
        directory += "PK\x01\x02" + little_endian(20, 2) + shared(entry.zip64) + little_endian(entry.name.size(), 2) +
                     little_endian(extra.size(), 2) + little_endian(0, 10) +
                     little_endian(entry.zip64 ? elsewhere : all.size(), 4) + entry.name + extra;
        all += "PK\x03\x04" + shared(false) + little_endian(local.size(), 2) + little_endian(0, 2) + local + packed;
        zip64 = zip64 || entry.zip64;
    }
    const std::uint64_t at = all.size(), count = entries.size();
    all += directory;
    if (zip64) {
        const std::uint64_t end = all.size();
        all += "PK\x06\x06" + little_endian(44, 8) + little_endian(0, 12) + little_endian(count, 8) +
               little_endian(count, 8) + little_endian(directory.size(), 8) + little_endian(at, 8);
        all += "PK\x06\x07" + little_endian(0, 4) + little_endian(end, 8) + little_endian(1, 4);
    }
    return all + "PK\x05\x06" + little_endian(0, 4) + little_endian(count, 2) + little_endian(count, 2) +
           little_endian(directory.size(), 4) + little_endian(zip64 ? elsewhere : at, 4) +
           little_endian(comment.size(), 2) + comment;
}

}  // namespace hausbench
