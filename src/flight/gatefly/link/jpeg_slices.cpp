// SPDX-License-Identifier: Apache-2.0
#include "gatefly/link/jpeg_slices.hpp"

namespace gatefly::jpeg_slices {
namespace {

/// How far `a` is ahead of `b`; numbers begin again at 0 after 2³² − 1.
std::int32_t ahead(std::uint32_t a, std::uint32_t b) { return static_cast<std::int32_t>(a - b); }

bool same_picture(const Header& a, const Header& b) {
  return a.total_chunks == b.total_chunks && a.jpeg_size == b.jpeg_size &&
         a.sim_time_ns == b.sim_time_ns;
}

std::chrono::nanoseconds time_of(const Header& header) {
  return std::chrono::nanoseconds{static_cast<std::int64_t>(header.sim_time_ns)};
}

}  // namespace

Assembler::Assembler(const AssemblerParams& params)
    : params_{params}, begun_(std::max<std::size_t>(1, params.pictures)), jpeg_(params.most_bytes) {
  for (Begun& begun : begun_) {
    begun.data.resize(params_.most_bytes);
    begun.slice.resize(params_.most_chunks);
  }
}

bool Assembler::is_slice(const Header& header, Bytes payload) const {
  return header.payload_size == payload.size() && header.payload_size > 0 &&
         header.chunk_id < header.total_chunks && header.total_chunks <= params_.most_chunks &&
         header.jpeg_size <= params_.most_bytes && header.payload_size <= header.jpeg_size;
}

bool Assembler::is_over(std::uint32_t frame_id) const {
  return newest_ && ahead(frame_id, *newest_) <= 0;
}

void Assembler::give_up(Begun& begun) {
  counts_.given_up += begun.used ? 1 : 0;
  begun.used = false;
}

void Assembler::forget() {
  for (Begun& begun : begun_) give_up(begun);
  newest_.reset();
}

Assembler::Begun& Assembler::place_for(const Header& header) {
  for (Begun& begun : begun_)
    if (begun.used && begun.header.frame_id == header.frame_id) return begun;
  // A free place, or that of the picture of which nothing has come for the longest time: a number that is
  // wrong may be higher than all to come, but no slices follow it.
  Begun* place = &begun_.front();
  for (Begun& begun : begun_)
    if (place->used && (!begun.used || begun.touched < place->touched)) place = &begun;
  give_up(*place);
  ++counts_.begun;
  place->used = true;
  place->header = header;
  place->bytes = place->slices = 0;
  std::fill_n(place->slice.begin(), header.total_chunks, Slice{});
  return *place;
}

Picture Assembler::completed(Begun& begun) {
  std::size_t at = 0;
  for (std::size_t i = 0; i < begun.header.total_chunks; ++i) {
    const Slice& slice = begun.slice[i];
    std::copy_n(begun.data.begin() + slice.at, slice.size,
                jpeg_.begin() + static_cast<std::ptrdiff_t>(at));
    at += slice.size;
  }
  begun.used = false;
  ++counts_.pictures;
  newest_ = begun.header.frame_id;
  for (Begun& other : begun_)
    if (other.used && is_over(other.header.frame_id)) give_up(other);
  return {begun.header.frame_id, time_of(begun.header), Bytes{jpeg_}.first(at)};
}

std::optional<Picture> Assembler::take(Bytes datagram) {
  const auto header = link::decoded<Header>(datagram);
  const Bytes payload = datagram.subspan(std::min(kHeaderSize, datagram.size()));
  if (!header || !is_slice(*header, payload)) {
    ++counts_.refused;
    return std::nullopt;
  }
  if (newest_ && ahead(*newest_, header->frame_id) > std::int64_t{params_.restart}) forget();
  if (is_over(header->frame_id)) {
    ++counts_.late;
    return std::nullopt;
  }
  Begun& begun = place_for(*header);
  begun.touched = ++taken_;
  Slice& slice = begun.slice[header->chunk_id];
  if (same_picture(begun.header, *header) && slice.here) {
    ++counts_.doubled;
    return std::nullopt;
  }
  if (!same_picture(begun.header, *header) ||
      begun.bytes + payload.size() > begun.header.jpeg_size) {
    ++counts_.refused;
    return std::nullopt;
  }
  slice = {static_cast<std::uint32_t>(begun.bytes), header->payload_size, true};
  std::copy(payload.begin(), payload.end(),
            begun.data.begin() + static_cast<std::ptrdiff_t>(begun.bytes));
  begun.bytes += payload.size();
  if (++begun.slices < begun.header.total_chunks) return std::nullopt;
  if (begun.bytes != begun.header.jpeg_size) {  // whole, and not as long as it said
    ++counts_.refused;
    give_up(begun);
    return std::nullopt;
  }
  return completed(begun);
}

}  // namespace gatefly::jpeg_slices
