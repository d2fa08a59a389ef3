// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/smoke_painter.h"

#include <cstddef>

namespace calot::gui {

SmokePainter::SmokePainter(const GlFunctions& gl) : gl_(gl) {
  gl_.GenVertexArrays(1, &vertexArray_);
  gl_.GenBuffers(1, &vertexBuffer_);
  gl_.GenBuffers(1, &indexBuffer_);
  gl_.BindVertexArray(vertexArray_);
  gl_.BindBuffer(GL_ARRAY_BUFFER, vertexBuffer_);
  gl_.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indexBuffer_);
  GLuint attribute = 0;
  const auto give = [&](GLint size, std::size_t offset) {
    gl_.EnableVertexAttribArray(attribute);
    gl_.VertexAttribPointer(attribute++, size, GL_FLOAT, GL_FALSE, sizeof(SmokeVertex),
                            reinterpret_cast<const void*>(offset));
  };
  give(3, offsetof(SmokeVertex, position));
  give(2, offsetof(SmokeVertex, corner));
  give(2, offsetof(SmokeVertex, opacity));  // and the offset behind it
}

SmokePainter::~SmokePainter() {
  gl_.DeleteBuffers(1, &vertexBuffer_);
  gl_.DeleteBuffers(1, &indexBuffer_);
  gl_.DeleteVertexArrays(1, &vertexArray_);
}

void SmokePainter::draw(const SmokeList& list) const {
  gl_.BindVertexArray(vertexArray_);
  gl_.BindBuffer(GL_ARRAY_BUFFER, vertexBuffer_);
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(list.vertex.size() * sizeof(SmokeVertex)), list.vertex.data(),
                 GL_STREAM_DRAW);
  gl_.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(list.index.size() * sizeof(std::uint32_t)),
                 list.index.data(), GL_STREAM_DRAW);
  // Colours come multiplied by their opacity; the farthest puff comes first, and none hides anything.
  gl_.Enable(GL_BLEND);
  gl_.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  gl_.DepthMask(GL_FALSE);
  gl_.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(list.index.size()), GL_UNSIGNED_INT, nullptr);
  gl_.DepthMask(GL_TRUE);
  gl_.Disable(GL_BLEND);
}

}  // namespace calot::gui
